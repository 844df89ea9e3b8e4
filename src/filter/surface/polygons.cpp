// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/polygons.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_topology.h"
#include "data/field_ops.h"
#include "filter/mesh/merge_points.h"
#include "filter/mesh/surface.h"

namespace sg::surface {

namespace {

constexpr size_t polygons_per_chunk = 1 << 13;

// A surface of other cells: `cells` gives for each new cell the cell whose fields it has.
DatasetPtr with_cells(const Dataset& in, SurfaceMesh mesh, const std::vector<int64_t>& cells) {
  DatasetParts out;
  for (const Field& f : in.fields())
    if (f.association != Association::cell) out.fields.add(f);
  carry_gathered(out.fields, in.fields(), Association::cell, cells, Association::cell);
  out.mesh = std::move(mesh);
  out.point_ghost = in.point_ghost();
  out.notes = in.notes();
  out.time = in.time();
  return make_dataset(std::move(out));
}

DatasetPtr without_strips(const DatasetPtr& in) {
  SurfaceMesh m = *in->as<SurfaceMesh>();
  const CellsView strips = cells_view(m.strips), polygons = cells_view(m.polygons);
  const size_t before = m.vertices.size() + m.lines.size() + polygons.count;
  std::vector<int64_t> ids, offsets{0}, cells(before);
  std::iota(cells.begin(), cells.end(), 0);
  for (size_t c = 0; c < polygons.count; ++c) {
    for (size_t k = polygons.begin(c); k < polygons.end(c); ++k) ids.push_back(polygons.connectivity[k]);
    offsets.push_back(int64_t(ids.size()));
  }
  for (size_t c = 0; c < strips.count; ++c)
    for (size_t k = 0; k + 2 < strips.size(c); ++k) {
      for (size_t p : {k, k + 1 + k % 2, k + 2 - k % 2}) ids.push_back(strips.point(c, p));
      offsets.push_back(int64_t(ids.size()));
      cells.push_back(int64_t(before + c));
    }
  m.strips = {};
  m.polygons = {id_array(ids), id_array(offsets), 0};
  return with_cells(*in, std::move(m), cells);
}

}  // namespace

DatasetPtr polygon_surface(const DatasetPtr& in, std::string_view who, Context& ctx) {
  if (in->as<PointCloud>()) fail_usage("a point cloud has no faces", std::string(who), "make a surface first, with resample and contour");
  DatasetPtr s = surface_of(in, ctx);
  if (in->as<AmrGrid>()) s = merge_points(s, {}, ctx);
  if (s->as<SurfaceMesh>()->strips.size() > 0) s = without_strips(s);
  const SurfaceMesh& m = *s->as<SurfaceMesh>();
  if (m.polygons.size() == 0 && m.cell_count() > 0)
    fail_usage("the mesh has only points and lines, no faces", std::string(who),
               "use a surface, a flat grid or a solid mesh (its outer surface is taken)");
  if (m.points.count() >= INT32_MAX || m.polygons.connectivity.count() >= INT32_MAX)
    fail_usage("the surface has more than 2^31 points or corners", std::string(who), "take a part of it first");
  return s;
}

DatasetPtr triangle_surface(const DatasetPtr& in, std::string_view who, Context& ctx) {
  const DatasetPtr s = polygon_surface(in, who, ctx);
  SurfaceMesh m = *s->as<SurfaceMesh>();
  if (m.polygons.fixed == 3 && m.vertices.size() + m.lines.size() == 0) return s;
  const Triangles t = triangles_of(m);
  std::vector<int64_t> cells(t.count());
  for (size_t i = 0; i < cells.size(); ++i) cells[i] = int64_t(t.cell(i));
  m.vertices = m.lines = {};
  m.polygons = {id_array(t.indices), {}, 3};
  return with_cells(*s, std::move(m), cells);
}

std::vector<Vec3> positions(const Points& points) {
  const PointReader reader(points);
  std::vector<Vec3> at(points.count());
  parallel_for(at.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) at[i] = reader[i];
  });
  return at;
}

std::vector<uint32_t> equal_places(const std::vector<Vec3>& at) {
  std::vector<uint32_t> order, into(at.size());
  for (uint32_t i = 0; i < at.size(); ++i) {
    into[i] = i;
    if (!std::isnan(at[i].x) && !std::isnan(at[i].y) && !std::isnan(at[i].z)) order.push_back(i);
  }
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return std::tie(at[a].x, at[a].y, at[a].z, a) < std::tie(at[b].x, at[b].y, at[b].z, b); });
  for (size_t i = 1; i < order.size(); ++i)
    if (at[order[i]] == at[order[i - 1]]) into[order[i]] = into[order[i - 1]];
  return into;
}

Edges edges_of_polygons(const CellsView& polygons, size_t points) {
  // Sides are put in the list of their smaller point; each list is sorted on its own.
  struct Side {
    uint32_t other;
    Edges::Use use;
  };
  auto each_side = [&](auto&& f) {
    for (size_t c = 0; c < polygons.count; ++c)
      for (size_t k = polygons.begin(c); k < polygons.end(c); ++k) {
        const int64_t a = polygons.connectivity[k], b = polygons.connectivity[next_corner(polygons, c, k)];
        if (a != b) f(size_t(std::min(a, b)), Side{uint32_t(std::max(a, b)), {uint32_t(k), uint32_t(c), a < b}});
      }
  };
  std::vector<size_t> start(points + 1, 0);
  each_side([&](size_t p, const Side&) { ++start[p]; });
  const size_t total = exclusive_scan(start);
  std::vector<Side> sides(total);
  std::vector<size_t> next(start.begin(), start.end());
  each_side([&](size_t p, const Side& s) { sides[next[p]++] = s; });
  std::vector<size_t> count(points + 1, 0);
  parallel_for(points, 1 << 14, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      const auto b = sides.begin() + ptrdiff_t(start[p]), e = sides.begin() + ptrdiff_t(start[p + 1]);
      std::sort(b, e, [](const Side& x, const Side& y) { return x.other != y.other ? x.other < y.other : x.use.corner < y.use.corner; });
      for (auto i = b; i != e; ++i) count[p] += i == b || i->other != (i - 1)->other;
    }
  });
  const size_t edges = exclusive_scan(count);
  Edges r;
  r.lo.resize(edges), r.hi.resize(edges), r.begin.resize(edges + 1), r.uses.resize(total);
  r.begin[edges] = uint32_t(total);
  parallel_for(points, 1 << 14, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      size_t e = count[p];
      for (size_t i = start[p]; i < start[p + 1]; ++i) {
        r.uses[i] = sides[i].use;
        if (i == start[p] || sides[i].other != sides[i - 1].other)
          r.lo[e] = uint32_t(p), r.hi[e] = sides[i].other, r.begin[e++] = uint32_t(i);
      }
    }
  });
  return r;
}

std::vector<Vec3> vector_areas(const CellsView& polygons, const std::vector<Vec3>& at) {
  std::vector<Vec3> areas(polygons.count);
  parallel_for(polygons.count, polygons_per_chunk, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
      Vec3 sum;
      const size_t first = polygons.begin(c), last = polygons.end(c);
      if (last - first < 3) continue;
      const Vec3 o = at[size_t(polygons.connectivity[first])];
      for (size_t k = first + 1; k + 1 < last; ++k)
        sum += cross(at[size_t(polygons.connectivity[k])] - o, at[size_t(polygons.connectivity[k + 1])] - o);
      areas[c] = sum * 0.5;
    }
  });
  return areas;
}

Orientation orientation(const CellsView& polygons, const Edges& edges, const std::vector<Vec3>& at, bool outward) {
  // Neighbours across edges of two polygons; `turned`: both run along the edge in the same direction.
  std::vector<size_t> start(polygons.count + 1, 0);
  for (size_t e = 0; e < edges.size(); ++e)
    if (const auto u = edges.of(e); u.size() == 2 && u[0].polygon != u[1].polygon) ++start[u[0].polygon], ++start[u[1].polygon];
  std::vector<std::pair<uint32_t, uint8_t>> neighbor(exclusive_scan(start));
  std::vector<size_t> next(start.begin(), start.end());
  for (size_t e = 0; e < edges.size(); ++e)
    if (const auto u = edges.of(e); u.size() == 2 && u[0].polygon != u[1].polygon) {
      const uint8_t turned = u[0].forward == u[1].forward;
      neighbor[next[u[0].polygon]++] = {u[1].polygon, turned};
      neighbor[next[u[1].polygon]++] = {u[0].polygon, turned};
    }
  Orientation r;
  r.flip.assign(polygons.count, 0);
  r.component.assign(polygons.count, UINT32_MAX);
  std::vector<uint32_t> stack, members;
  std::vector<std::vector<uint32_t>> of_component;
  for (size_t seed = 0; seed < polygons.count; ++seed) {
    if (r.component[seed] != UINT32_MAX) continue;
    const auto number = uint32_t(of_component.size());
    members.clear();
    stack.assign(1, uint32_t(seed));
    r.component[seed] = number;
    bool one_sided = false;
    size_t turned = 0;
    while (!stack.empty()) {
      const uint32_t c = stack.back();
      stack.pop_back();
      members.push_back(c);
      turned += r.flip[c];
      for (size_t i = start[c]; i < start[c + 1]; ++i) {
        const auto [n, t] = neighbor[i];
        const auto wanted = uint8_t(r.flip[c] ^ t);
        if (r.component[n] == UINT32_MAX) r.component[n] = number, r.flip[n] = wanted, stack.push_back(n);
        else one_sided = one_sided || r.flip[n] != wanted;
      }
    }
    r.one_sided += one_sided;
    if (2 * turned > members.size())
      for (uint32_t c : members) r.flip[c] ^= 1;
    of_component.push_back(members);
  }
  r.closed.assign(of_component.size(), 1);
  for (size_t e = 0; e < edges.size(); ++e)
    if (const auto u = edges.of(e); u.size() != 2 || u[0].polygon == u[1].polygon)
      for (const auto& use : u) r.closed[r.component[use.polygon]] = 0;
  if (outward)
    for (size_t k = 0; k < of_component.size(); ++k) {
      if (!r.closed[k]) continue;
      double volume = 0;
      const auto& list = of_component[k];
      const Vec3 o = at[size_t(polygons.connectivity[polygons.begin(list[0])])];
      for (uint32_t c : list) {
        double part = 0;
        const size_t first = polygons.begin(c);
        const Vec3 a = at[size_t(polygons.connectivity[first])] - o;
        for (size_t i = first + 1; i + 1 < polygons.end(c); ++i)
          part += dot(a, cross(at[size_t(polygons.connectivity[i])] - o, at[size_t(polygons.connectivity[i + 1])] - o));
        volume += r.flip[c] ? -part : part;
      }
      if (volume < 0)
        for (uint32_t c : list) r.flip[c] ^= 1;
    }
  for (uint8_t f : r.flip) r.flipped += f;
  return r;
}

SurfaceMesh oriented(const SurfaceMesh& mesh, const Orientation& o) {
  if (o.flipped == 0) return mesh;
  SurfaceMesh r = mesh;
  const CellsView polygons = cells_view(mesh.polygons);
  std::vector<int32_t> ids(mesh.polygons.connectivity.count());
  for (size_t c = 0; c < polygons.count; ++c) {
    const size_t first = polygons.begin(c), n = polygons.size(c);
    for (size_t k = 0; k < n; ++k) ids[first + k] = int32_t(polygons.connectivity[first + (o.flip[c] ? (n - k) % n : k)]);
  }
  r.polygons.connectivity = Array::from_vector(std::move(ids));
  return r;
}

}  // namespace sg::surface
