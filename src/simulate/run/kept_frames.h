// SPDX-License-Identifier: Apache-2.0
// Frames of runs that will be asked for again: a film looks at some of all times before it draws each, and its runs are to be simulated
// once.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "data/dataset.h"
#include "simulate/run/frame_params.h"

namespace sg {

/// While it lives, runs keep what they show at these times as soon as they pass them, as long as that takes at most `most` bytes together;
/// what does not fit is simulated again. Several may live at once, and on any thread.
class KeptFrames {
 public:
  KeptFrames(std::vector<double> times, size_t most);
  ~KeptFrames();
  KeptFrames(const KeptFrames&) = delete;
  KeptFrames& operator=(const KeptFrames&) = delete;

  /// Whether one lives.
  static bool any();
  /// Of those that live, together.
  static size_t bytes();
  /// What was kept of the run `key`; null: nothing.
  static DatasetPtr find(const std::string& key, size_t frame);
  /// Whether somebody wants this frame of a run, and none has it.
  static bool wants(const std::string& key, const FrameParams& params, size_t frame);
  static void keep(const std::string& key, const FrameParams& params, size_t frame, const DatasetPtr& data);

 private:
  struct State;
  State* state_;
};

}  // namespace sg
