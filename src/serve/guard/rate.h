// SPDX-License-Identifier: Apache-2.0
// So many a second, and as many at once after a rest.
#pragma once
#include <algorithm>
#include <chrono>

namespace sg::serve {

class Rate {
 public:
  using Clock = std::chrono::steady_clock;
  explicit Rate(double per_second, Clock::time_point now = Clock::now()) : per_second_(per_second), left_(per_second), last_(now) {}

  /// One more; false when it comes too early.
  bool take(Clock::time_point now = Clock::now()) {
    left_ = std::min(per_second_, left_ + per_second_ * std::chrono::duration<double>(now - last_).count());
    last_ = now;
    if (left_ < 1) return false;
    left_ -= 1;
    return true;
  }
  /// From the last take() until the next one succeeds.
  std::chrono::milliseconds wait() const {
    return std::chrono::milliseconds(left_ >= 1 ? 0 : 1 + int64_t(1000 * (1 - left_) / per_second_));
  }

 private:
  double per_second_, left_;
  Clock::time_point last_;
};

}  // namespace sg::serve
