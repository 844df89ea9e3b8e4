// SPDX-License-Identifier: Apache-2.0
#include "render/trace/progress/sweeps.h"

#include <algorithm>
#include <cmath>

namespace sg::trace {

namespace {

constexpr uint32_t largest_sweep = 16;

}  // namespace

Sweeps::Sweeps(const LightOptions& options, const LightWatch& watch) : watch_(watch), seconds_(options.seconds) {}

uint32_t Sweeps::next(uint32_t n, uint32_t least, double pixels) {
  uint32_t paths = std::max(least, std::min(n, largest_sweep - n % largest_sweep));
  swept_at_ = now();
  if (seconds_ > 0 && n > 0) {
    // Sweeps differ a little in what they take.
    const double there_is_time_for = 0.95 * (seconds_ - swept_at_) / std::max(pace_ * pixels, 1e-9);
    if (!(there_is_time_for >= least)) return 0;
    if (there_is_time_for < paths) paths = uint32_t(there_is_time_for) / least * least;
  }
  work_ = double(paths) * pixels;
  return paths;
}

void Sweeps::done() { pace_ = (now() - swept_at_) / std::max(work_, 1.0); }

bool Sweeps::wanted() { return watch_.on_frame && (shown_ == 0 || now() - shown_at_ >= watch_.every * shown_); }

bool Sweeps::show(const Frame& frame, const TraceReport& report) {
  ++shown_;
  const bool more = watch_.on_frame(frame, report);
  shown_at_ = now();
  return more;
}

}  // namespace sg::trace
