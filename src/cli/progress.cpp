// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdio>

#include "base/text/utf8.h"
#include "cli/say.h"

namespace sg {

namespace {

std::string duration(double seconds) {
  if (seconds < 60) return fmt::format("{:.0f} s", std::ceil(seconds));
  if (seconds < 3600) return fmt::format("{:.0f} min", std::ceil(seconds / 60));
  return fmt::format("{:.1f} h", seconds / 3600);
}

}  // namespace

std::string progress_text(double fraction, std::string_view doing, double seconds) {
  std::string text = fmt::format("{:3.0f}% {}", fraction * 100, doing.substr(0, 60));
  if (seconds > 2 && fraction > 0.02) text += fmt::format(", {} left", duration(seconds * (1 - fraction) / fraction));
  return text;
}

void ProgressLine::show(double fraction, std::string_view doing) {
  constexpr std::chrono::milliseconds between(100);
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  if (fraction < last_) begin_ = now;
  last_ = fraction;
  if (fraction >= 1) return clear();
  if (visible_ && now - drawn_ < between) return;
  drawn_ = now, visible_ = true;
  const double seconds = std::chrono::duration<double>(now - begin_).count();
  std::fprintf(stderr, "\r%s\x1b[K", printable(progress_text(fraction, doing, seconds)).c_str());
}

void ProgressLine::print(const std::string& line) {
  const std::lock_guard lock(mutex_);
  clear();
  say_error(line);
}

void ProgressLine::clear() {
  if (visible_) std::fprintf(stderr, "\r\x1b[K");
  visible_ = false;
}

}  // namespace sg
