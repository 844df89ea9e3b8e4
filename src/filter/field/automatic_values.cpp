// SPDX-License-Identifier: Apache-2.0
#include "filter/field/automatic_values.h"

#include <fmt/core.h>

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
  std::vector<double> values;
  const double step = (range.hi - range.lo) / (count + 1);
  for (int k = 1; k <= count && !range.empty(); ++k)
    values.push_back(round_near(range.lo + (range.hi - range.lo) * k / (count + 1), 0.05 * step));
  return values;
}

}  // namespace sg
