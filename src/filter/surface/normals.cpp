// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/normals.h"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>

#include "base/error.h"
#include "base/parallel.h"
#include "base/union_find.h"
#include "data/field_ops.h"
#include "filter/surface/polygons.h"

namespace sg {

namespace {

using namespace surface;

using std::numbers::pi;

// Angle inside the polygon at a corner, also above 180 degrees.
double corner_angle(Vec3 before, Vec3 here, Vec3 after, Vec3 normal) {
  const Vec3 a = after - here, b = before - here, n = cross(a, b);
  const double angle = std::atan2(length(n), dot(a, b));
  return dot(n, normal) < 0 ? 2 * pi - angle : angle;
}

// Corners of a point that belong to one smooth piece come into one set.
void join_across_smooth_edges(UnionFind<>& corners, const CellsView& polygons, const Edges& edges, const std::vector<Vec3>& normal,
                              double feature_angle) {
  const double cosine = std::cos(feature_angle * pi / 180);
  for (size_t e = 0; e < edges.size(); ++e) {
    const auto u = edges.of(e);
    if (u.size() != 2 || u[0].forward == u[1].forward) continue;
    const Vec3 &m = normal[u[0].polygon], &n = normal[u[1].polygon];
    const bool flat = m == Vec3() || n == Vec3();  // a polygon of no area bends nothing
    if (!flat && dot(m, n) < cosine - 1e-12) continue;
    const auto first = u[0].corner, first_end = uint32_t(next_corner(polygons, u[0].polygon, first));
    const auto second = u[1].corner, second_end = uint32_t(next_corner(polygons, u[1].polygon, second));
    corners.join(first, second_end);
    corners.join(first_end, second);
  }
}

struct SplitPoints {
  std::vector<int64_t> source;      // input point of each point
  std::vector<uint32_t> of_corner;  // point of each corner
};

SplitPoints split_points(const CellsView& polygons, const Edges& edges, const std::vector<Vec3>& normal, size_t points,
                         double feature_angle) {
  const size_t n = polygons.count ? polygons.end(polygons.count - 1) : 0;
  SplitPoints r;
  r.source.resize(points);
  std::iota(r.source.begin(), r.source.end(), 0);
  r.of_corner.resize(n);
  if (feature_angle >= 180) {
    for (size_t c = 0; c < n; ++c) r.of_corner[c] = uint32_t(polygons.connectivity[c]);
    return r;
  }
  UnionFind<> corners(n);
  join_across_smooth_edges(corners, polygons, edges, normal, feature_angle);
  std::vector<uint8_t> taken(points, 0);  // the first piece keeps the point
  for (uint32_t c = 0; c < n; ++c) {
    const uint32_t root = corners.root(c);
    if (root != c) {
      r.of_corner[c] = r.of_corner[root];  // roots come before their corners
      continue;
    }
    const auto p = size_t(polygons.connectivity[c]);
    if (!taken[p]) taken[p] = 1, r.of_corner[c] = uint32_t(p);
    else r.of_corner[c] = uint32_t(r.source.size()), r.source.push_back(int64_t(p));
  }
  return r;
}

// Sums are taken corner by corner in their order, whatever the threads.
Array point_normals(const CellsView& polygons, const std::vector<Vec3>& at, const std::vector<Vec3>& normal, const SplitPoints& s) {
  const size_t n = s.of_corner.size();
  std::vector<double> weight(n);
  parallel_for(polygons.count, 1 << 12, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c)
      for (size_t k = polygons.begin(c); k < polygons.end(c); ++k) {
        auto p = [&](size_t corner) { return at[size_t(polygons.connectivity[corner])]; };
        weight[k] = corner_angle(p(previous_corner(polygons, c, k)), p(k), p(next_corner(polygons, c, k)), normal[c]);
      }
  });
  std::vector<Vec3> sum(s.source.size());
  for (size_t c = 0; c < polygons.count; ++c)
    for (size_t k = polygons.begin(c); k < polygons.end(c); ++k) sum[s.of_corner[k]] += normal[c] * weight[k];
  float* to = nullptr;
  Array r = Array::make<float>(sum.size(), 3, &to);
  for (size_t i = 0; i < sum.size(); ++i) {
    const Vec3 u = normalize(sum[i]);
    to[3 * i] = float(u.x), to[3 * i + 1] = float(u.y), to[3 * i + 2] = float(u.z);
  }
  return r;
}

}  // namespace

DatasetPtr normals(const DatasetPtr& in, const NormalsParams& p, Context& ctx) {
  const DatasetPtr s = polygon_surface(in, "normals", ctx);
  SurfaceMesh mesh = *s->as<SurfaceMesh>();
  const std::vector<Vec3> at = positions(mesh.points);
  Edges edges = edges_of_polygons(cells_view(mesh.polygons), at.size());
  if (p.orient != Facing::keep || p.flip) {
    Orientation o;
    if (p.orient != Facing::keep) o = orientation(cells_view(mesh.polygons), edges, at, p.orient == Facing::outward);
    else o.flip.assign(mesh.polygons.size(), 0);
    if (o.one_sided > 0) ctx.warn(fmt::format("normals: {} pieces are one-sided and cannot be oriented", o.one_sided));
    if (o.flipped > 0) ctx.info(fmt::format("normals: {} polygons were reversed", o.flipped));
    if (p.flip)
      for (uint8_t& f : o.flip) f ^= 1;
    o.flipped = size_t(std::count(o.flip.begin(), o.flip.end(), 1));
    if (o.flipped > 0) {
      mesh = oriented(mesh, o);
      edges = edges_of_polygons(cells_view(mesh.polygons), at.size());
    }
  }
  ctx.check();
  const CellsView polygons = cells_view(mesh.polygons);
  std::vector<Vec3> normal = vector_areas(polygons, at);
  for (Vec3& n : normal) n = normalize(n);
  const SplitPoints split = split_points(polygons, edges, normal, at.size(), p.feature_angle);
  Array values = point_normals(polygons, at, normal, split);

  DatasetParts out;
  const bool doubled = split.source.size() > at.size();
  if (doubled) {
    mesh.points = gather_points(mesh.points, split.source);
    mesh.polygons.connectivity = id_array(split.of_corner);
    carry_gathered(out.fields, s->fields(), Association::point, split.source, Association::point);
    for (const Field& f : s->fields())
      if (f.association != Association::point) out.fields.add(f);
    if (!s->point_ghost().empty()) out.point_ghost = gather(s->point_ghost(), split.source);
  } else {
    out.fields = s->fields();
    out.point_ghost = s->point_ghost();
  }
  out.fields.add({"Normals", Association::point, std::move(values), "", Role::normals});
  if (p.cell_normals) {
    std::vector<float> list(3 * mesh.cell_count(), 0.0f);
    const size_t first = mesh.vertices.size() + mesh.lines.size();
    for (size_t c = 0; c < polygons.count; ++c)
      for (int a = 0; a < 3; ++a) list[3 * (first + c) + size_t(a)] = float(normal[c][a]);
    out.fields.add({"Cell normals", Association::cell, Array::from_vector(std::move(list), 3), "", Role::normals});
  }
  out.mesh = std::move(mesh);
  out.notes = s->notes();
  out.time = s->time();
  return make_dataset(std::move(out));
}

}  // namespace sg
