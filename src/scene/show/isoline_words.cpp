// SPDX-License-Identifier: Apache-2.0
#include "scene/show/isoline_words.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/schema/color_params.h"
#include "color/parse_color.h"
#include "filter/field/automatic_values.h"

namespace sg {

void describe(Schema& s, IsolineShow& p) {
  s("isolines", p.isolines,
    "About how many lines of equal value, at round ones, are drawn on the surface; 0: none. They are as wide everywhere, and fade where "
    "they "
    "would be closer than a few pixels.")
      .range(0, 1000);
  s("isoline_values", p.isoline_values, "The values of these lines instead.");
  s("isoline_field", p.isoline_field, "Point field of these values; default: the one that colours the surface.").takes(fields::on_points);
  s("isoline_width", p.isoline_width, "Width of these lines.").unit("pixels").range(0.1, 50);
  s("isoline_color", p.isoline_color, "Colour of these lines.").unit(color_unit);
}

std::optional<SurfaceIsolines> isolines_of(const Dataset& d, const IsolineShow& p, const std::optional<FieldColor>& color) {
  if (!p.any()) return {};
  SurfaceIsolines lines;
  Range range;
  if (!p.isoline_field.empty()) {
    lines.field = d.fields().require(p.isoline_field.name, Association::point).name;
  } else {
    if (!color || color->direct)
      fail_usage("no field colours the surface, so that its lines have no values", "isolines", "name one: isoline_field=NAME");
    if (color->association != Association::point)
      fail_usage(fmt::format("'{}' has one value for each cell, and no lines between", color->field), "isolines",
                 "-f cell_to_point averages it to points");
    lines.field = color->field, lines.component = color->component;
    range = {std::min(color->scale.lo, color->scale.hi), std::max(color->scale.lo, color->scale.hi)};
  }
  if (range.empty()) range = d.range(d.fields().require(lines.field, Association::point), lines.component);
  lines.values = p.isoline_values.empty() ? even_values(range, p.isolines) : p.isoline_values;
  for (const double v : lines.values)
    if (!std::isfinite(v)) fail_usage(fmt::format("{} is no value that a line could have", v), "isoline_values", "give finite numbers");
  std::sort(lines.values.begin(), lines.values.end());
  lines.width = p.isoline_width, lines.color = parse_color(p.isoline_color, "isoline_color");
  return lines;
}

}  // namespace sg
