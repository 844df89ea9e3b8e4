// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/report/picture_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/overloaded.h"

namespace sg {

namespace {

struct Drawn {
  size_t triangles = 0, segments = 0, points = 0, glyphs = 0, volumes = 0;
};

// A polygon of n corners is n - 2 triangles, a line of n points n - 1 segments.
size_t less_per_cell(const CellArray& cells, size_t less) {
  const size_t corners = cells.connectivity.count();
  return corners - std::min(corners, less * cells.size());
}

Drawn count(const Scene& scene) {
  Drawn n;
  const auto surface = [](const DatasetPtr& d) { return d ? std::get_if<SurfaceMesh>(&d->mesh()) : nullptr; };
  for (const Item& item : scene.items)
    std::visit(Overloaded{
                   [&](const SurfaceItem& i) {
                     if (const SurfaceMesh* m = surface(i.data)) n.triangles += less_per_cell(m->polygons, 2) + less_per_cell(m->strips, 2);
                   },
                   [&](const LinesItem& i) {
                     if (const SurfaceMesh* m = surface(i.data)) n.segments += less_per_cell(m->lines, 1);
                   },
                   [&](const PointsItem& i) { n.points += i.data ? i.data->point_count() : 0; },
                   [&](const GlyphsItem& i) { n.glyphs += i.data ? i.data->point_count() : 0; },
                   [&](const VolumeItem&) { ++n.volumes; },
               },
               item);
  return n;
}

}  // namespace

std::string drawn_text(const Scene& scene, const RenderOptions& options) {
  const Drawn n = count(scene);
  std::vector<std::string> parts;
  const auto add = [&](size_t of, const char* what) {
    if (of > 0) parts.push_back(fmt::format("{} {}{}", of, what, of == 1 ? "" : "s"));
  };
  add(n.triangles, "triangle"), add(n.segments, "line segment"), add(n.points, "point"), add(n.glyphs, "glyph");
  if (n.volumes > 0) {
    const size_t pixels = size_t(options.width) * size_t(options.height);
    parts.push_back(fmt::format("{} volume{} by rays through {} pixels", n.volumes, n.volumes == 1 ? "" : "s", pixels));
  }
  return parts.empty() ? "nothing" : fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace sg
