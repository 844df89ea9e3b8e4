// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/shared_scale.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/all_ranks.h"
#include "color/map_files/colormap_file.h"
#include "color/parse_color.h"
#include "data/field_ops.h"
#include "data/ranks/over_all.h"
#include "scene/choose/scale.h"

namespace sg {

bool share_scale(std::span<const FieldOf> fields, ColoringParams& p, const Context& context) {
  const bool categorical = p.map && !names_colormap_file(*p.map) && find_colormap(*p.map).categorical();
  if (categorical || (!p.map && p.range.empty() && p.scale == ScaleKind::linear)) p.labels = labels_of(fields, categorical, context);
  if (!p.labels.values.empty()) return true;
  Range all;
  bool same = true;
  for (const FieldOf& f : fields) {
    const Range r = range_over_all(*f.data, *f.field, f.field->components() > 1 ? p.component : 0, context);
    same = same && (&f == &fields.front() || r == all);
    all.add(r);
  }
  const bool automatic = !p.map && p.scale != ScaleKind::log;
  const bool is_signed = two_sided(*fields[0].field, all);
  ShownRange shown{all};
  if (automatic && p.scale == ScaleKind::linear) shown = shown_range(fields, p.component, is_signed, context);
  else if (automatic && is_signed) shown.range.hi = std::max(-all.lo, all.hi), shown.range.lo = -shown.range.hi;
  const bool cut = shown.cut_low || shown.cut_high;
  if ((same && !cut) || !(all.lo < all.hi)) return false;
  const std::string map(is_signed ? "coolwarm" : sequential_map(*fields[0].data, *fields[0].field));
  if (automatic) p.map = map, p.map_chosen = true;
  if (!p.range.empty()) return true;
  p.range = {shown.range.lo, shown.range.hi}, p.range_of = all;
  const auto triangle = [&](std::string& color, double at) {  // in the legend
    if (color.empty()) color = color_text(find_colormap(map).at(at));
  };
  if (shown.cut_low) triangle(p.below, 0);
  if (shown.cut_high) triangle(p.above, 1);
  return true;
}

bool share_range(const Field& one, Range all, ColoringParams& p) {
  if (!p.range.empty() || !(all.lo < all.hi)) return false;
  if (!p.map && two_sided(one, all)) {  // values of both signs: no colour for one side only
    const double most = std::max(-all.lo, all.hi);
    all = {-most, most};
  }
  p.range = {all.lo, all.hi};
  return true;
}

std::array<uint64_t, 3> count_beyond(std::span<const FieldOf> fields, const ColoringParams& p) {
  std::array<uint64_t, 3> counts{};
  for (const FieldOf& f : fields) {
    const Array values = scalar_of(*f.field, p.component, ElementType::f64);
    for (size_t i = 0; i < values.count(); ++i) {
      const double v = values.get(i);
      if (std::isnan(v)) continue;
      counts[0] += v<p.range[0], counts[1] += v> p.range[1], ++counts[2];
    }
  }
  return counts;
}

bool tells_beyond(const ColoringParams& p) { return p.range.size() == 2 && p.range_of.empty() && (!p.below.empty() || !p.above.empty()); }

void tell_beyond(const Field& field, std::array<uint64_t, 3> counts, const Context& context) {
  all_sum(std::span<uint64_t>(counts), context.communicator);
  if (counts[2] == 0) return;
  const auto share = [&](uint64_t n) {
    const double percent = 100 * double(n) / double(counts[2]);
    return n == 0 ? std::string("none") : percent < 0.1 ? std::string("less than 0.1 %") : fmt::format("{:.2g} %", percent);
  };
  context.info(fmt::format("of the values of '{}' {} lie below the range and {} above", field.name, share(counts[0]), share(counts[1])));
}

}  // namespace sg
