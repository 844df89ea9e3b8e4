// SPDX-License-Identifier: Apache-2.0
#include "filter/field/automatic_values.h"

#include <fmt/core.h>

#include <cmath>

#include "base/text/round_number.h"
#include "base/text/text.h"
#include "data/ranks/over_all.h"

namespace sg {

double middle_value(const Dataset& data, const Field& field, int component, std::string_view who, const Context& context) {
  const Range range = range_over_all(data, field, component, context);
  if (range.empty()) return 0;
  const double half = 0.5 * range.hi - 0.5 * range.lo;
  const double value = round_near(range.lo + half, 0.1 * half);
  context.info(fmt::format("{}: {} = {}, near the middle of {} to {}", who, field.name, short_number(value), short_number(range.lo),
                           short_number(range.hi)));
  return value;
}

std::vector<double> even_values(const Range& range, int count) {
  if (range.empty() || count < 1) return {};
  if (!(range.lo < range.hi)) return {range.lo};
  const double width = range.hi - range.lo, middle = range.lo + 0.5 * width;
  if (count == 1) return {round_near(middle, 0.05 * width)};
  // Of the round steps about that of even spacing the one that gives the nearest number; lines at the very ends would be single points.
  struct Choice {
    double step = 0, first = 0, last = 0;  ///< multiples of the step
    double off = HUGE_VAL;
  } best;
  const double power = std::pow(10.0, std::floor(std::log10(width / (count + 1))));
  for (const double scale : {0.1, 1.0, 10.0})
    for (const double digit : {1.0, 2.0, 2.5, 5.0}) {
      const double step = digit * scale * power, hair = 1e-6 * step;
      const double first = std::ceil((range.lo + hair) / step), last = std::floor((range.hi - hair) / step);
      const double off = std::abs(last - first + 1 - count);
      if (last >= first && off < best.off) best = {step, first, last, off};
    }
  std::vector<double> values;
  for (double k = best.first; best.step > 0 && k <= best.last && values.size() <= 4 * size_t(count); ++k) {
    const double digits = round_near(k * best.step, 1e-9 * best.step);  // 0.3, not 0.30000000000000004
    if (!values.empty() && !(digits > values.back())) break;            // steps below what doubles tell apart
    values.push_back(digits);
  }
  return values;
}

std::vector<double> automatic_values(const Dataset& data, const Field& field, int component, int count, std::string_view who,
                                     const Context& context) {
  if (count > 1) {
    std::vector<double> values = even_values(range_over_all(data, field, component, context), count);
    if (values.size() > 1) {
      context.info(fmt::format("{}: {} = {} to {} in steps of {}", who, field.name, short_number(values.front()),
                               short_number(values.back()), short_number(values[1] - values[0])));
      return values;
    }
  }
  return {middle_value(data, field, component, who, context)};
}

}  // namespace sg
