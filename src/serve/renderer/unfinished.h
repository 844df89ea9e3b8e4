// SPDX-License-Identifier: Apache-2.0
// Pictures by paths of light that were interrupted, to be gone on with when the same view is wanted again.
#pragma once
#include <cstdint>
#include <deque>
#include <mutex>

#include "render/trace/progress/light_watch.h"
#include "serve/renderer/renderer.h"

namespace sg::serve {

/// Safe from any number of threads.
class Unfinished {
 public:
  /// Together they take no more than that: older ones go, and what is larger by itself is not kept.
  explicit Unfinished(uint64_t most_bytes) : most_(most_bytes) {}
  /// Of that view, size and camera of that picture (a number of what is loaded); empty where there is none. It is not kept any more, nor is
  /// what there is of the view otherwise.
  LightSoFar take(const DrawRequest& request, uint64_t picture);
  void keep(const DrawRequest& request, uint64_t picture, LightSoFar so_far);
  void forget(int view);
  void clear();

 private:
  struct Kept {
    DrawRequest request;
    uint64_t picture;
    LightSoFar so_far;
  };
  const uint64_t most_;
  std::mutex mutex_;
  std::deque<Kept> kept_;  ///< one of a view, the last one that was interrupted at the end
};

}  // namespace sg::serve
