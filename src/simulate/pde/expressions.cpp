// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/expressions.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"
#include "data/dataset.h"
#include "filter/field/calc/calc.h"

namespace sg::pde {

Values values_of(const std::string& expression, const UniformGrid& grid, double time, const std::string& who, const Context& context,
                 int component) {
  DatasetParts parts;
  parts.mesh = grid, parts.time = time;
  Context inner(context, 0, 1);
  const DatasetPtr d = with_context(
      who, [&] { return calc(make_dataset(std::move(parts)), {.expr = expression, .name = "value", .on = CalcPlace::point}, inner); });
  const Array& a = d->fields().require("value", Association::point).array;
  if (component >= a.components() || (component == 0 && a.components() != 1 && a.components() != 3))
    fail_usage(fmt::format("the expression gives {} numbers", a.components()), who, component ? "vec(u,v,w)" : "one number is needed");
  Values v(grid.dims);
  for (size_t i = 0; i < v.values.size(); ++i) {
    v.values[i] = a.get(i, component);
    if (std::isfinite(v.values[i])) continue;
    const Vec3 at = grid.origin + grid.spacing * Vec3(double(i % v.n[0]), double(i / v.n[0] % v.n[1]), double(i / (v.n[0] * v.n[1])));
    fail_data(fmt::format("{} at {}, {}, {}", std::isnan(v.values[i]) ? "not a number" : "infinite", exact_number(at.x), exact_number(at.y),
                          exact_number(at.z)),
              who, "the expression must have a finite value everywhere in the box");
  }
  return v;
}

std::string place_in(const Room& room, size_t axis) {
  if (room.axes[axis].flat()) return "0.5";
  double longest = 0;
  for (const Axis& a : room.axes) longest = std::max(longest, a.length);
  return fmt::format("(({}-({}))/{})", "xyz"[axis], exact_number(room.corner[int(axis)]), exact_number(longest));
}

std::string bump_in(const Room& room, double sharpness, std::array<double, 3> shares) {
  double longest = 0;
  for (const Axis& a : room.axes) longest = std::max(longest, a.length);
  std::string sum = "0";
  for (size_t a = 0; a < 3; ++a)
    if (!room.axes[a].flat()) sum += fmt::format("+({}-{})^2", place_in(room, a), exact_number(shares[a] * room.axes[a].length / longest));
  return fmt::format("exp(-{}*({}))", exact_number(sharpness), sum);
}

bool depends_on_time(const std::string& expression) {
  const auto names = names_in_expression(expression);
  return std::find(names.begin(), names.end(), "time") != names.end();
}

}  // namespace sg::pde
