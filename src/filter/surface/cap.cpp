// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/cap.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "data/cells/triangulate_loops.h"
#include "data/field_ops.h"
#include "filter/surface/polygons.h"

namespace sg {

namespace {

using namespace surface;

struct BorderLoop {
  std::vector<uint32_t> points;   // against the surface's own direction: the way a cap runs
  uint32_t polygon = 0;           // at the first edge
  Vec3 normal, center;            // of its best plane
  double perimeter = 0, off = 0;  // largest distance from the plane
};

// Borders as rings of points; where several meet, the first edge continues.
std::vector<BorderLoop> border_loops(const Edges& edges, const std::vector<Vec3>& at, size_t& open) {
  struct Side {
    uint32_t from, to, polygon;
  };
  std::vector<Side> sides;
  for (size_t e = 0; e < edges.size(); ++e)
    if (const auto u = edges.of(e); u.size() == 1)
      sides.push_back(u[0].forward ? Side{edges.hi[e], edges.lo[e], u[0].polygon} : Side{edges.lo[e], edges.hi[e], u[0].polygon});
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.from != b.from ? a.from < b.from : a.to < b.to; });
  std::vector<uint8_t> done(sides.size(), 0);
  auto next = [&](uint32_t from) -> size_t {
    auto i =
        size_t(std::lower_bound(sides.begin(), sides.end(), from, [](const Side& s, uint32_t p) { return s.from < p; }) - sides.begin());
    while (i < sides.size() && sides[i].from == from && done[i]) ++i;
    return i < sides.size() && sides[i].from == from ? i : SIZE_MAX;
  };
  std::vector<BorderLoop> loops;
  std::vector<size_t> place(at.size(), SIZE_MAX);  // of each point in the way so far
  std::vector<uint32_t> way, way_polygon;
  for (size_t first = 0; first < sides.size(); ++first) {
    if (done[first]) continue;
    way.clear(), way_polygon.clear();
    for (size_t i = first; i != SIZE_MAX; i = next(sides[i].to)) {
      done[i] = 1;
      place[sides[i].from] = way.size();
      way.push_back(sides[i].from), way_polygon.push_back(sides[i].polygon);
      const size_t back = place[sides[i].to];
      if (back == SIZE_MAX) continue;
      // The way has come back to one of its points: what lies between is a loop.
      BorderLoop l;
      l.points.assign(way.begin() + ptrdiff_t(back), way.end());
      l.polygon = way_polygon[back];
      for (uint32_t p : l.points) place[p] = SIZE_MAX;
      way.resize(back), way_polygon.resize(back);
      loops.push_back(std::move(l));
      if (way.empty()) break;
    }
    open += way.size();
    for (uint32_t p : way) place[p] = SIZE_MAX;
  }
  for (BorderLoop& l : loops) {
    Vec3 sum, area;
    for (uint32_t p : l.points) sum += at[p];
    l.center = sum / double(l.points.size());
    for (size_t k = 0; k < l.points.size(); ++k) {
      const Vec3 a = at[l.points[k]] - l.center, b = at[l.points[(k + 1) % l.points.size()]] - l.center;
      area += cross(a, b), l.perimeter += length(b - a);
    }
    l.normal = normalize(area);
    for (uint32_t p : l.points) l.off = std::max(l.off, std::abs(dot(at[p] - l.center, l.normal)));
  }
  return loops;
}

struct Caps {
  std::vector<uint32_t> corners;  // points of the surface, three a triangle
  std::vector<int64_t> polygon;   // whose cell fields each triangle has
  std::vector<uint32_t> group;    // plane of each triangle
  std::vector<Vec3> normal;       // of each plane
};

void close_group(const std::vector<BorderLoop>& loops, std::span<const size_t> members, const std::vector<Vec3>& at, Caps& out) {
  size_t widest = members[0];
  for (size_t m : members)
    if (loops[m].perimeter > loops[widest].perimeter) widest = m;
  const Vec3 n = loops[widest].normal, o = loops[widest].center;
  const Vec3 helper = std::abs(n.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 u = normalize(cross(helper, n)), v = cross(n, u);
  std::vector<Vec2> flat;
  std::vector<uint32_t> id;
  std::vector<std::vector<uint32_t>> rings;
  for (size_t m : members) {
    rings.emplace_back();
    for (uint32_t p : loops[m].points) {
      rings.back().push_back(uint32_t(flat.size()));
      flat.push_back({dot(at[p] - o, u), dot(at[p] - o, v)});
      id.push_back(p);
    }
  }
  std::vector<uint32_t> triangles;
  triangulate_loops(flat, rings, triangles);
  for (uint32_t t : triangles) out.corners.push_back(id[t]);
  out.polygon.insert(out.polygon.end(), triangles.size() / 3, int64_t(loops[widest].polygon));
  out.group.insert(out.group.end(), triangles.size() / 3, uint32_t(out.normal.size()));
  out.normal.push_back(n);
}

Caps close_loops(const std::vector<BorderLoop>& loops, const std::vector<Vec3>& at, double tolerance) {
  Caps caps;
  std::vector<uint8_t> taken(loops.size(), 0);
  std::vector<size_t> group;
  for (size_t i = 0; i < loops.size(); ++i) {
    if (taken[i]) continue;
    group.assign(1, i);
    for (size_t k = i + 1; loops[i].off <= tolerance && k < loops.size(); ++k) {
      if (taken[k] || loops[k].off > tolerance) continue;
      double off = 0;
      for (uint32_t p : loops[k].points) off = std::max(off, std::abs(dot(at[p] - loops[i].center, loops[i].normal)));
      for (uint32_t p : loops[i].points) off = std::max(off, std::abs(dot(at[p] - loops[k].center, loops[k].normal)));
      if (off <= tolerance) taken[k] = 1, group.push_back(k);
    }
    close_group(loops, group, at, caps);
  }
  return caps;
}

// The surface (or nothing of it) with the caps behind.
DatasetPtr with_caps(const Dataset& s, SurfaceMesh mesh, const Caps& caps, bool only_cap) {
  const Field* normal = s.fields().with_role(Role::normals);
  if (normal && (normal->association != Association::point || normal->components() != 3)) normal = nullptr;
  const auto first_polygon = int64_t(mesh.vertices.size() + mesh.lines.size());
  std::vector<int64_t> points(mesh.points.count()), cells(only_cap ? 0 : mesh.cell_count());
  std::iota(points.begin(), points.end(), 0), std::iota(cells.begin(), cells.end(), 0);
  const size_t kept_points = points.size(), kept_cells = cells.size();
  std::vector<int32_t> ids, offsets{0};
  if (!only_cap) {
    const CellsView polygons = cells_view(mesh.polygons);
    for (size_t c = 0; c < polygons.count; ++c) {
      for (size_t k = polygons.begin(c); k < polygons.end(c); ++k) ids.push_back(int32_t(polygons.connectivity[k]));
      offsets.push_back(int32_t(ids.size()));
    }
  } else {
    mesh.vertices = mesh.lines = {};
  }
  std::vector<std::vector<std::pair<uint32_t, int32_t>>> number(caps.normal.size());  // own points of a plane: sorted below
  std::vector<Vec3> normals;
  if (normal || only_cap) {
    for (size_t t = 0; t < caps.group.size(); ++t)
      for (size_t k = 0; k < 3; ++k) number[caps.group[t]].push_back({caps.corners[3 * t + k], 0});
    for (size_t g = 0; g < number.size(); ++g) {
      auto& list = number[g];
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
      for (auto& [p, n] : list) n = int32_t(points.size()), points.push_back(p), normals.push_back(caps.normal[g]);
    }
  }
  for (size_t t = 0; t < caps.group.size(); ++t) {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t p = caps.corners[3 * t + k];
      const auto& list = number[caps.group[t]];
      if (list.empty()) ids.push_back(int32_t(p));
      else ids.push_back(std::lower_bound(list.begin(), list.end(), std::pair<uint32_t, int32_t>{p, 0})->second);
    }
    offsets.push_back(int32_t(ids.size()));
    cells.push_back(first_polygon + caps.polygon[t]);
  }
  if (only_cap) {
    points.erase(points.begin(), points.begin() + ptrdiff_t(kept_points));
    for (int32_t& i : ids) i -= int32_t(kept_points);
  }
  DatasetParts out;
  mesh.points = gather_points(mesh.points, points);
  mesh.polygons = {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  carry_gathered(out.fields, s.fields(), Association::point, points, Association::point);
  carry_gathered(out.fields, s.fields(), Association::cell, cells, Association::cell);
  carry_whole(out.fields, s.fields());
  std::vector<uint8_t> mark(cells.size(), 1);
  std::fill_n(mark.begin(), kept_cells, uint8_t(0));
  out.fields.add({"cap", Association::cell, Array::from_vector(std::move(mark)), "", Role::labels});
  if (normal) {
    Array a = gather(normal->array, std::span<const int64_t>(points)).converted(ElementType::f32);
    std::vector<float> v(a.view<float>().data, a.view<float>().data + 3 * a.count());
    const size_t first = points.size() - normals.size();
    for (size_t i = 0; i < normals.size(); ++i)
      for (int c = 0; c < 3; ++c) v[3 * (first + i) + size_t(c)] = float(normals[i][c]);
    out.fields.add({normal->name, Association::point, Array::from_vector(std::move(v), 3), normal->unit, Role::normals});
  }
  out.mesh = std::move(mesh);
  out.notes = s.notes();
  out.time = s.time();
  return make_dataset(std::move(out));
}

}  // namespace

DatasetPtr cap(const DatasetPtr& in, const CapParams& p, Context& ctx) {
  const DatasetPtr s = polygon_surface(in, "cap", ctx);
  SurfaceMesh mesh = *s->as<SurfaceMesh>();
  const std::vector<Vec3> at = positions(mesh.points);
  // Edges between points that are the same place.
  const std::vector<uint32_t> same = equal_places(at);
  auto merged = [&](const SurfaceMesh& m) {
    std::vector<int32_t> ids(m.polygons.connectivity.count());
    const IndexView v = index_view(m.polygons.connectivity);
    for (size_t k = 0; k < ids.size(); ++k) ids[k] = int32_t(same[size_t(v[k])]);
    return CellArray{Array::from_vector(std::move(ids)), m.polygons.offsets, m.polygons.fixed};
  };
  CellArray joined = merged(mesh);
  Edges edges = edges_of_polygons(cells_view(joined), at.size());
  const Orientation o = orientation(cells_view(joined), edges, at, false);
  if (o.flipped > 0) {
    mesh = oriented(mesh, o);
    joined = merged(mesh);
    edges = edges_of_polygons(cells_view(joined), at.size());
  }
  ctx.check();
  size_t open = 0;
  std::vector<BorderLoop> loops = border_loops(edges, at, open);
  if (open > 0) ctx.warn(fmt::format("cap: {} open edges do not belong to a loop and stay open", open));
  if (p.max_perimeter > 0) std::erase_if(loops, [&](const BorderLoop& l) { return l.perimeter > p.max_perimeter; });
  const double tolerance = p.tolerance * s->bounds().diagonal();
  const auto bent = size_t(std::count_if(loops.begin(), loops.end(), [&](const BorderLoop& l) { return l.off > tolerance; }));
  if (bent > 0) ctx.info(fmt::format("cap: {} of {} holes are not planar and were closed in their best-fitting plane", bent, loops.size()));
  if (loops.empty()) ctx.info("cap: there is no hole to close");
  const Caps caps = close_loops(loops, at, tolerance);
  return with_caps(*s, std::move(mesh), caps, p.only_cap);
}

}  // namespace sg
