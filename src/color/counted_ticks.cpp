// SPDX-License-Identifier: Apache-2.0
#include "color/counted_ticks.h"

#include <algorithm>
#include <cmath>

#include "base/text/text.h"

namespace sg {

namespace {

TickLabel tick(const ColorScale& s, double value) { return {value, short_number(value, digits_between(s))}; }

// By steps less round than 1, 2 and 5; none where none of these gives so many.
std::vector<TickLabel> by_other_steps(const ColorScale& s, double count) {
  const double lo = std::min(s.lo, s.hi), hi = std::max(s.lo, s.hi);
  if (s.kind != ScaleKind::linear || !(lo < hi)) return {};
  const double decade = std::pow(10, std::floor(std::log10((hi - lo) / count)));
  for (const double unit : {1.5, 3.0, 4.0, 6.0, 15.0}) {
    const double step = unit * decade, slack = 1e-9 * step, first = std::ceil((lo - slack) / step);
    if (std::floor((hi + slack) / step) - first + 1 != count) continue;
    std::vector<TickLabel> ticks;
    for (double i = 0; i < count; ++i) ticks.push_back(tick(s, (first + i) * step));
    return ticks;
  }
  return {};
}

}  // namespace

int digits_between(const ColorScale& s) {
  const double largest = std::max(std::abs(s.lo), std::abs(s.hi)), range = std::abs(s.hi - s.lo);
  return range > 0 && s.kind == ScaleKind::linear ? std::clamp(int(std::ceil(std::log10(largest / range))) + 3, 3, 15) : 3;
}

std::vector<TickLabel> counted_ticks(const ColorScale& s) {
  const auto count = size_t(s.tick_count);
  std::vector<TickLabel> few;
  for (int wanted = 1; wanted <= 2 * s.tick_count; ++wanted) {
    std::vector<TickLabel> ticks = nice_ticks(s.lo, s.hi, wanted, s.kind, s.linear_threshold);
    std::erase_if(ticks, [&](const TickLabel& t) { return !(s.position(t.value) >= 0 && s.position(t.value) <= 1); });
    if (ticks.size() == count) return ticks;
    if (few.empty()) few = ticks;
  }
  if (count == 1) return few.empty() ? few : std::vector{few[few.size() / 2]};
  if (const auto ticks = by_other_steps(s, double(count)); !ticks.empty()) return ticks;
  std::vector<TickLabel> ticks;
  for (size_t i = 0; i < count; ++i) ticks.push_back(tick(s, s.value_at(double(i) / double(count - 1))));
  return ticks;
}

}  // namespace sg
