// SPDX-License-Identifier: Apache-2.0
// Sweeps: how many paths a pixel are drawn over the whole picture before it is looked at again, so that it is even when time is over.
#pragma once
#include <chrono>
#include <cstdint>

#include "render/trace/light_options.h"
#include "render/trace/progress/light_watch.h"

namespace sg::trace {

class Sweeps {
 public:
  /// Time runs from here on.
  Sweeps(const LightOptions& options, const LightWatch& watch);

  /// Whether the picture is looked at on the way at all.
  bool any() const { return seconds_ > 0 || watch_.on_frame; }
  /// Where to begin, and to leave what was drawn of a cancelled picture; null: nowhere.
  LightSoFar* so_far() const { return seconds_ > 0 ? nullptr : watch_.so_far; }
  /// Paths a pixel of the next sweep over `pixels` that are not finished, of which each has n: as many again, at most 16, or what there is
  /// time for by the pace of the last sweep; 0 when there is none left. No less than `least` otherwise, and `least` where n is 0.
  uint32_t next(uint32_t n, uint32_t least, double pixels);
  /// What next() said was drawn.
  void done();
  /// Whether a picture is wanted now.
  bool wanted();
  /// Of such a picture; false: no more.
  bool show(const Frame& frame, const TraceReport& report);

 private:
  using Clock = std::chrono::steady_clock;
  double now() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

  const LightWatch& watch_;
  double seconds_;
  Clock::time_point begin_ = Clock::now();
  double swept_at_ = 0, work_ = 0, pace_ = 0;  // when the sweep began, its paths of all pixels, seconds for each of the last one's
  double shown_at_ = 0;
  int shown_ = 0;
};

}  // namespace sg::trace
