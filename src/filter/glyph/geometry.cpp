// SPDX-License-Identifier: Apache-2.0
#include "filter/glyph/geometry.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/memory/memory_budget.h"
#include "filter/mesh/surface.h"

namespace sg {

namespace {

constexpr size_t glyphs_per_chunk = 1 << 10;

struct Shape {
  std::vector<float> xyz;
  std::vector<int32_t> lines, triangles;  // two and three point numbers each
  size_t points() const { return xyz.size() / 3; }
};

Shape shape_of(const DatasetPtr& data) {
  const auto* mesh = data->as<SurfaceMesh>();
  if (!mesh) fail_usage("a shape must be a surface mesh", "glyphs");
  Shape s;
  for (size_t i = 0; i < mesh->points.count(); ++i) {
    const Vec3 p = mesh->points.at(i);
    s.xyz.insert(s.xyz.end(), {float(p.x), float(p.y), float(p.z)});
  }
  const CellsView lines = cells_view(mesh->lines);
  for (size_t c = 0; c < lines.count; ++c)
    for (size_t k = 0; k + 1 < lines.size(c); ++k)
      s.lines.insert(s.lines.end(), {int32_t(lines.point(c, k)), int32_t(lines.point(c, k + 1))});
  const Triangles t = triangles_of(*mesh);
  s.triangles.assign(t.indices.begin(), t.indices.end());
  return s;
}

}  // namespace

DatasetPtr glyph_geometry(const DatasetPtr& data, const GlyphRule& rule, const std::vector<DatasetPtr>& meshes, Context& context) {
  const auto instances = glyph_instances(data, rule, meshes.size());
  std::vector<Shape> shapes;
  for (const DatasetPtr& m : meshes) shapes.push_back(shape_of(m));
  const size_t n = instances->count();
  auto shape_at = [&](size_t i) -> const Shape* {
    if (!instances->stands(i)) return nullptr;
    return &shapes[instances->shape_numbers() ? instances->shape_numbers()[i] : 0];
  };
  // Where each chunk's points, lines and triangles go.
  const size_t chunks = (n + glyphs_per_chunk - 1) / glyphs_per_chunk;
  std::vector<size_t> points(chunks), lines(chunks), triangles(chunks);
  parallel_for(n, glyphs_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (const Shape* s = shape_at(i))
        points[begin / glyphs_per_chunk] += s->points(), lines[begin / glyphs_per_chunk] += s->lines.size(),
            triangles[begin / glyphs_per_chunk] += s->triangles.size();
  });
  const size_t all_points = exclusive_scan(points), all_lines = exclusive_scan(lines), all_triangles = exclusive_scan(triangles);
  double bytes = 12;
  for (const Field& f : data->fields()) bytes += double(f.components()) * double(element_size(f.array.type()));
  need_memory(double(all_points) * bytes + 4 * double(all_lines + all_triangles), fmt::format("{} glyphs", instances->standing), "glyphs",
              "use fewer points (glyph_points) or a simpler shape");
  if (all_points >= size_t(INT32_MAX) || all_triangles / 3 + all_lines / 2 >= size_t(INT32_MAX))
    fail_usage(fmt::format("{} glyphs make {} points", instances->standing, all_points), "glyphs",
               "use fewer points (glyph_points) or a simpler shape; pictures draw glyphs without their geometry");
  float* xyz = nullptr;
  int32_t *segment = nullptr, *corner = nullptr;
  SurfaceMesh mesh;
  mesh.points = {Array::make<float>(all_points, 3, &xyz), instances->origin};
  if (all_lines) mesh.lines.connectivity = Array::make<int32_t>(all_lines, 1, &segment), mesh.lines.fixed = 2;
  if (all_triangles) mesh.polygons.connectivity = Array::make<int32_t>(all_triangles, 1, &corner), mesh.polygons.fixed = 3;
  std::vector<uint32_t> source(all_points);
  parallel_for(
      n, glyphs_per_chunk,
      [&](size_t begin, size_t end) {
        size_t p = points[begin / glyphs_per_chunk], l = lines[begin / glyphs_per_chunk], t = triangles[begin / glyphs_per_chunk];
        for (size_t i = begin; i < end; ++i) {
          const Shape* s = shape_at(i);
          if (!s) continue;
          const float* m = instances->data() + 12 * i;
          for (const int32_t k : s->lines) segment[l++] = int32_t(p) + k;
          for (const int32_t k : s->triangles) corner[t++] = int32_t(p) + k;
          for (size_t k = 0; k < s->points(); ++k, ++p) {
            glyph_point(m, s->xyz[3 * k], s->xyz[3 * k + 1], s->xyz[3 * k + 2], xyz + 3 * p);
            source[p] = uint32_t(i);
          }
        }
      },
      &context);
  FieldSet fields;
  carry_gathered(fields, data->fields(), Association::point, std::span<const uint32_t>(source), Association::point);
  carry_whole(fields, data->fields());
  for (size_t i = 0; i < fields.size(); ++i)  // normals of the places are not those of the glyphs
    if (fields[i].role == Role::normals || fields[i].role == Role::tcoords) {
      Field f = fields[i];
      f.role = Role::none;
      fields.add(std::move(f));
    }
  return make_dataset(Mesh(std::move(mesh)), std::move(fields));
}

}  // namespace sg
