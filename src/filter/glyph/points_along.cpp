// SPDX-License-Identifier: Apache-2.0
// Even spacing along lines, for barbs on streamlines (Pilar, Ware 2013).
#include "filter/glyph/points_along.h"

#include <algorithm>

#include <fmt/core.h>

#include "base/error.h"
#include "data/field_ops.h"

namespace sg {

/// Places that 32-bit numbers of points still name.
static constexpr double most_places = 1u << 31;

DatasetPtr points_along_lines(const DatasetPtr& data, const GlyphPointsParams& p) {
  const auto* mesh = data->as<SurfaceMesh>();
  if (!mesh || mesh->lines.size() == 0)
    fail_usage(fmt::format("the mesh ({}) has no lines", data->kind()), "glyph_points: mode=lines",
               "use streamlines, isolines or the like to make lines");
  const double spacing = p.spacing > 0 ? p.spacing : 0.06 * data->bounds().diagonal();
  const CellsView lines = cells_view(mesh->lines);
  NeighbourGrid near(std::max(spacing, 1e-300));
  std::vector<EdgePoint> places;
  std::vector<Vec3> at;
  std::vector<int64_t> cells;
  std::vector<double> tangents;
  std::vector<double> sum;
  for (size_t c = 0; c < lines.count && spacing > 0; ++c) {
    const size_t n = lines.size(c);
    auto point = [&](size_t k) { return mesh->points.at(size_t(lines.point(c, k))); };
    sum.assign(1, 0);
    for (size_t k = 1; k < n; ++k) sum.push_back(sum.back() + length(point(k) - point(k - 1)));
    if (!(sum.back() > 0) || !std::isfinite(sum.back())) continue;
    const double pieces = sum.back() / spacing;
    if (!(double(places.size()) + pieces < most_places))
      fail_usage(fmt::format("a spacing of {:.4g} makes more than {:.0f} points on the lines", spacing, most_places), "glyph_points",
                 "use a larger spacing");
    const auto steps = size_t(pieces);
    const double first = 0.5 * (sum.back() - double(steps) * spacing);
    size_t k = 1;
    for (size_t i = 0; i <= steps; ++i) {
      const double s = first + double(i) * spacing;
      while (k + 1 < n && sum[k] < s) ++k;
      const double own = sum[k] - sum[k - 1], t = own > 0 ? std::clamp((s - sum[k - 1]) / own, 0.0, 1.0) : 0.0;
      const Vec3 a = point(k - 1), b = point(k), q = lerp(a, b, t), along = normalize(b - a);
      const Vec3 from_middle = q - data->bounds().center();
      if (p.separation > 0 &&
          near.any(from_middle, [&](Vec3 other, int64_t) { return length(other - from_middle) < p.separation * spacing; }))
        continue;
      near.add(from_middle, 0);
      places.push_back({uint32_t(lines.point(c, k - 1)), uint32_t(lines.point(c, k)), float(t)});
      at.push_back(q), cells.push_back(int64_t(mesh->vertices.size() + c));
      for (int d = 0; d < 3; ++d) tangents.push_back(along[d]);
    }
  }
  FieldSet fields;
  carry_gathered(fields, data->fields(), Association::cell, std::span<const int64_t>(cells), Association::point);
  carry_interpolated(fields, data->fields(), places);
  fields.add({"tangent", Association::point, Array::from_vector(std::move(tangents), 3), "", Role::none});
  carry_whole(fields, data->fields());
  const Vec3 origin = data->bounds().empty() ? Vec3{} : data->bounds().center();
  std::vector<float> xyz;
  for (const Vec3& q : at)
    for (int d = 0; d < 3; ++d) xyz.push_back(float(q[d] - origin[d]));
  return make_dataset(Mesh(PointCloud{{Array::from_vector(std::move(xyz), 3), origin}}), std::move(fields));
}

}  // namespace sg
