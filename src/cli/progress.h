// SPDX-License-Identifier: Apache-2.0
// The line of a terminal that tells how far work has come, and messages that do not run into it.
#pragma once
#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

namespace sg {

/// "45% rendering, 12 s left" from a share in [0, 1] that was reached after `seconds`; the rest is told once it can be estimated.
std::string progress_text(double fraction, std::string_view doing, double seconds);

/// For standard error, from any thread.
class ProgressLine {
 public:
  /// Shows it anew, at most ten times a second; removes it at 1.
  void show(double fraction, std::string_view doing);
  /// Prints a line of its own; the next show() draws what was there below it.
  void print(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  void clear();

  std::mutex mutex_;
  bool visible_ = false;
  double last_ = 2;  // of a fraction: work of its own begins where it falls
  Clock::time_point begin_, drawn_;
};

}  // namespace sg
