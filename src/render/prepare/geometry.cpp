// SPDX-License-Identifier: Apache-2.0
// From cells to triangles and segments.
#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "filter/mesh/surface.h"
#include "render/prepare/prepared.h"

namespace sg::raster {

namespace {

constexpr size_t places_per_chunk = 1 << 15;

bool hidden(const uint8_t* ghost, size_t cell) {
  return ghost && (ghost[cell] & (ghost_duplicate | ghost_hidden_cell | ghost_refined_cell));
}

Array packed_ghosts(const Dataset& data) {
  return data.cell_ghost().empty() ? Array() : data.cell_ghost().converted(ElementType::u8).made_packed();
}

const uint8_t* bytes_of(const Array& a) { return a.empty() ? nullptr : reinterpret_cast<const uint8_t*>(a.raw()); }

/// i32 triangles without ghosts are drawn from where they lie.
bool in_place(const SurfaceMesh& mesh, const Dataset& data) {
  const CellArray& p = mesh.polygons;
  return p.fixed == 3 && p.connectivity.type() == ElementType::i32 && p.connectivity.packed() && mesh.strips.size() == 0 &&
         data.cell_ghost().empty();
}

struct Derived {
  Array triangles, cells;
  size_t bytes() const { return triangles.bytes() + cells.bytes(); }
};

/// All triangles but those of hidden cells.
Derived visible_triangles(const SurfaceMesh& mesh, const Dataset& data) {
  Triangles t = triangles_of(mesh);
  const Array ghosts = packed_ghosts(data);
  const uint8_t* ghost = bytes_of(ghosts);
  if (ghost) {
    Triangles kept;
    for (size_t i = 0; i < t.count(); ++i) {
      if (hidden(ghost, t.cell(i))) continue;
      kept.indices.insert(kept.indices.end(), t.indices.begin() + ptrdiff_t(3 * i), t.indices.begin() + ptrdiff_t(3 * i + 3));
      kept.cells.push_back(t.cell(i));
    }
    t = std::move(kept);
  }
  return {Array::from_vector(std::move(t.indices), 3), Array::from_vector(std::move(t.cells))};
}

}  // namespace

SurfaceMesh visible_polygons(const SurfaceMesh& mesh, const Dataset& data) {
  const Array ghosts = packed_ghosts(data);
  const uint8_t* ghost = bytes_of(ghosts);
  if (!ghost) return mesh;
  size_t cell = mesh.vertices.size() + mesh.lines.size();
  auto kept = [&](const CellArray& cells) {
    const CellsView v = cells_view(cells);
    std::vector<int64_t> ids, offsets{0};
    for (size_t c = 0; c < v.count; ++c, ++cell) {
      if (hidden(ghost, cell)) continue;
      for (size_t k = 0; k < v.size(c); ++k) ids.push_back(v.point(c, k));
      offsets.push_back(int64_t(ids.size()));
    }
    return CellArray{Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  };
  SurfaceMesh out;
  out.points = mesh.points, out.polygons = kept(mesh.polygons), out.strips = kept(mesh.strips);
  return out;
}

Positions packed_positions(const DatasetPtr& data, const Points& points) {
  if (points.xyz.type() == ElementType::f32 && points.xyz.packed()) return {points.xyz, points.origin};
  return *derived(data, "positions", [&]() -> Positions {
    if (points.xyz.type() == ElementType::f32) return {points.xyz.made_packed(), points.origin};
    // The f32 numbers that are left must be small: they are taken from the middle of the data.
    const Box3& box = data->bounds();
    const Vec3 middle = box.empty() ? points.origin : box.center(), shift = points.origin - middle;
    float* out = nullptr;
    Positions p{Array::make<float>(points.count(), 3, &out), middle};
    dispatch(points.xyz, [&](auto v) {
      parallel_for(v.count, places_per_chunk, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
          for (int c = 0; c < 3; ++c) out[3 * i + size_t(c)] = float(double(v(i, c)) + shift[c]);
      });
    });
    return p;
  });
}

TriangleSet triangulate(const DatasetPtr& data, bool& any_polygon) {
  const SurfaceMesh& mesh = *data->as<SurfaceMesh>();
  any_polygon = mesh.polygons.size() + mesh.strips.size() > 0;
  if (mesh.points.count() >= (size_t(1) << 29))
    fail_usage(fmt::format("a surface of {} points is too large to draw", mesh.points.count()), "surface", "decimate it or draw its parts");
  TriangleSet s;
  const Positions positions = packed_positions(data, mesh.points);
  s.positions = positions.xyz, s.origin = positions.origin;
  if (mesh.polygons.connectivity.count() + mesh.strips.connectivity.count() >= (size_t(1) << 31))  // the kernels count in 32 bits
    fail_usage(fmt::format("a surface of {} polygons is too large to draw", mesh.polygons.size()), "surface",
               "decimate it or draw its parts");
  if (in_place(mesh, *data)) {
    s.triangles = mesh.polygons.connectivity, s.count = mesh.polygons.size();
    s.first_cell = uint32_t(mesh.vertices.size() + mesh.lines.size());
    return s;
  }
  const auto d = derived(data, "triangles", [&] { return visible_triangles(mesh, *data); });
  s.triangles = d->triangles, s.cells = d->cells, s.count = d->triangles.count();
  return s;
}

SegmentSet line_segments(const Dataset& data, const SurfaceMesh& mesh) {
  const Array ghosts = packed_ghosts(data);
  const uint8_t* ghost = bytes_of(ghosts);
  const CellsView lines = cells_view(mesh.lines);
  const size_t before = mesh.vertices.size();
  SegmentSet s;
  for (size_t c = 0; c < lines.count; ++c) {
    if (hidden(ghost, before + c)) continue;
    const size_t n = lines.size(c);
    for (size_t k = 0; k + 1 < n; ++k) {
      s.points.push_back(uint32_t(lines.point(c, k))), s.points.push_back(uint32_t(lines.point(c, k + 1)));
      s.cells.push_back(uint32_t(before + c)), s.groups.push_back(uint32_t(c));
    }
  }
  return s;
}

SegmentSet curved_edges(const Dataset& data, const SurfaceMesh& mesh) {
  SegmentSet s = line_segments(data, mesh);
  s.room.resize(s.count());
  for (size_t i = 0, end; i < s.count(); i = end) {
    double all = 0;
    for (end = i; end < s.count() && s.groups[end] == s.groups[i]; ++end)
      all += length(mesh.points.at(s.points[2 * end + 1]) - mesh.points.at(s.points[2 * end]));
    std::fill(s.room.begin() + ptrdiff_t(i), s.room.begin() + ptrdiff_t(end), float(all));
  }
  return s;
}

}  // namespace sg::raster
