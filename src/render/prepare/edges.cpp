// SPDX-License-Identifier: Apache-2.0
// The edges of the cells on a surface: which of them are drawn, and how much room each has.
#include <atomic>
#include <bit>
#include <cmath>

#include "base/parallel.h"
#include "base/union_find.h"
#include "filter/mesh/surface.h"
#include "render/prepare/prepared.h"

namespace sg::raster {

namespace {

// The place of an edge among those of `s`, which are in the order of their points.
size_t place_of(const SegmentSet& s, int64_t a, int64_t b) {
  const auto first = uint32_t(std::min(a, b)), second = uint32_t(std::max(a, b));
  size_t lo = 0, hi = s.count();
  while (lo < hi) {
    const size_t middle = (lo + hi) / 2;
    const bool before = s.points[2 * middle] != first ? s.points[2 * middle] < first : s.points[2 * middle + 1] < second;
    if (before) lo = middle + 1;
    else hi = middle;
  }
  return lo;
}

// Twice the area of a polygon, across it.
Vec3 twice_area(const SurfaceMesh& mesh, const CellsView& polygons, size_t c) {
  const auto at = [&](size_t k) { return mesh.points.at(size_t(polygons.point(c, k))); };
  Vec3 sum;
  for (size_t k = 1; k + 1 < polygons.size(c); ++k) sum += cross(at(k) - at(0), at(k + 1) - at(0));
  return sum;
}

// What a filter has made of one cell: polygons in one plane that show the same input cell, joined across the edges between them.
struct Pieces {
  std::vector<double> area;     ///< of all that a polygon is joined with
  std::vector<uint8_t> inside;  ///< of each edge: between two such polygons
};

Pieces pieces_of_cells(const SurfaceMesh& mesh, const Field& origin, const SegmentSet& s) {
  constexpr double flat = 1 - 1e-6;  // cosine between faces in one plane
  constexpr uint32_t none = 0xFFFFFFFFu;
  const CellsView polygons = cells_view(mesh.polygons);
  const size_t before = mesh.vertices.size() + mesh.lines.size();
  std::vector<Vec3> across(polygons.count);
  for (size_t c = 0; c < polygons.count; ++c) across[c] = twice_area(mesh, polygons, c);
  std::vector<uint32_t> first(s.count(), none);
  Pieces pieces{std::vector<double>(polygons.count), std::vector<uint8_t>(s.count())};
  UnionFind<uint32_t> joined(polygons.count);
  for (size_t c = 0; c < polygons.count; ++c)
    for (size_t k = 0, n = polygons.size(c); k < n; ++k) {
      const int64_t a = polygons.point(c, k), b = polygons.point(c, (k + 1) % n);
      if (a == b) continue;
      const size_t e = place_of(s, a, b);
      const uint32_t other = first[e];
      if (other == none) {
        first[e] = uint32_t(c);
        continue;
      }
      const double sizes = length(across[c]) * length(across[other]);
      if (origin.array.get(before + c) != origin.array.get(before + other) || !(dot(across[c], across[other]) > flat * sizes)) continue;
      pieces.inside[e] = 1;
      joined.join(uint32_t(c), other);
    }
  for (size_t c = 0; c < polygons.count; ++c) pieces.area[joined.root(uint32_t(c))] += 0.5 * length(across[c]);
  for (size_t c = 0; c < polygons.count; ++c) pieces.area[c] = pieces.area[joined.root(uint32_t(c))];
  return pieces;
}

// The width of each polygon across each of its edges: its height for triangles, its area by the edge's length for others; of pieces of a
// cell the side of a square as large as all of them. The smallest counts. Positive floats are in the order of their bits, so that threads
// may take minima.
void find_room(const SurfaceMesh& mesh, const Pieces* pieces, SegmentSet& s) {
  s.room.assign(s.count(), HUGE_VALF);
  const auto narrow = [&](int64_t a, int64_t b, double width) {
    if (a == b || !std::isfinite(width)) return;
    std::atomic_ref<uint32_t> bits(reinterpret_cast<uint32_t&>(s.room[place_of(s, a, b)]));
    const auto mine = std::bit_cast<uint32_t>(float(width));
    for (uint32_t seen = bits.load(); mine < seen && !bits.compare_exchange_weak(seen, mine);) {
    }
  };
  const CellsView polygons = cells_view(mesh.polygons), strips = cells_view(mesh.strips);
  const auto at = [&](int64_t id) { return mesh.points.at(size_t(id)); };
  parallel_for(polygons.count, 1 << 12, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
      const size_t n = polygons.size(c);
      if (n < 2) continue;
      const double own = 0.5 * length(twice_area(mesh, polygons, c)), whole = pieces ? pieces->area[c] : own;
      for (size_t k = 0; k < n; ++k) {
        const int64_t a = polygons.point(c, k), b = polygons.point(c, (k + 1) % n);
        const double width = own * (n == 3 ? 2 : 1) / length(at(b) - at(a));
        narrow(a, b, whole > 1.001 * own ? std::max(width, std::sqrt(whole)) : width);
      }
    }
  });
  parallel_for(strips.count, 1 << 8, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c)
      for (size_t k = 0; k + 2 < strips.size(c); ++k) {
        const int64_t id[3] = {strips.point(c, k), strips.point(c, k + 1), strips.point(c, k + 2)};
        const double area = length(cross(at(id[1]) - at(id[0]), at(id[2]) - at(id[0])));
        for (int e = 0; e < 3; ++e) narrow(id[e], id[(e + 1) % 3], area / length(at(id[(e + 1) % 3]) - at(id[e])));
      }
  });
}

}  // namespace

SegmentSet polygon_edges(const Dataset& data, const SurfaceMesh& mesh) {
  const SurfaceMesh visible = visible_polygons(mesh, data);
  SegmentSet s;
  s.points = edges_of(visible);
  const Field* origin = data.fields().find("original_cell", Association::cell);
  if (!origin || !data.cell_ghost().empty() || mesh.strips.size() > 0) {
    find_room(visible, nullptr, s);
    return s;
  }
  const Pieces pieces = pieces_of_cells(visible, *origin, s);
  find_room(visible, &pieces, s);
  SegmentSet kept;
  for (size_t e = 0; e < s.count(); ++e)
    if (!pieces.inside[e]) kept.points.insert(kept.points.end(), {s.points[2 * e], s.points[2 * e + 1]}), kept.room.push_back(s.room[e]);
  return kept;
}

}  // namespace sg::raster
