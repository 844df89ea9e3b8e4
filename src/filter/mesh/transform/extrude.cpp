// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/transform/extrude.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "base/error.h"
#include "base/text/round_number.h"
#include "base/text/text.h"
#include "data/field_ops.h"
#include "data/ranks/over_all.h"
#include "filter/mesh/surface.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

Vec3 chosen_direction(const Box3& box) {
  const Vec3 s = box.size();
  for (int a = 2; a >= 0; --a)
    if (s[a] <= 1e-6 * std::max({s.x, s.y, s.z})) {
      Vec3 d;
      d[a] = 1;
      return d;
    }
  return {0, 0, 1};
}

// Twice the area of a polygon times its normal (Newell).
Vec3 area_normal(const PointReader& at, const CellsView& cells, size_t c) {
  Vec3 n;
  const size_t k = cells.size(c);
  const Vec3 first = k ? at[size_t(cells.point(c, 0))] : Vec3();
  for (size_t i = 1; i + 1 < k; ++i) n += cross(at[size_t(cells.point(c, i))] - first, at[size_t(cells.point(c, i + 1))] - first);
  return n;
}

class Extruder {
 public:
  Extruder(const SurfaceMesh& mesh, Vec3 shift, bool caps)
      : mesh_(mesh), points_(int64_t(mesh.points.xyz.count())), at_(mesh.points), shift_(shift), caps_(caps) {}

  SurfaceMesh run() {
    const CellsView vertices = cells_view(mesh_.vertices), lines = cells_view(mesh_.lines), polygons = cells_view(mesh_.polygons);
    int64_t cell = 0;
    for (size_t c = 0; c < vertices.count; ++c, ++cell)
      for (size_t i = 0; i < vertices.size(c); ++i) lines_.add(std::array{vertices.point(c, i), vertices.point(c, i) + points_}, cell);
    for (size_t c = 0; c < lines.count; ++c, ++cell)
      for (size_t i = 0; i + 1 < lines.size(c); ++i) wall(lines.point(c, i), lines.point(c, i + 1), cell);
    const int64_t first_polygon = cell;
    if (caps_) close_ends(polygons, first_polygon);
    add_walls(polygons, first_polygon);
    SurfaceMesh r;
    r.points = twice();
    const auto same = [](int64_t id) { return int32_t(id); };
    r.lines = cell_array({&lines_}, same), r.polygons = cell_array({&polygons_}, same);
    return r;
  }
  std::vector<int64_t> sources() const {
    std::vector<int64_t> all = lines_.sources;
    all.insert(all.end(), polygons_.sources.begin(), polygons_.sources.end());
    return all;
  }

 private:
  bool faces_along(const CellsView& polygons, size_t c) const { return dot(area_normal(at_, polygons, c), shift_) > 0; }

  void wall(int64_t a, int64_t b, int64_t cell) { polygons_.add(std::array{a, b, b + points_, a + points_}, cell); }

  void close_ends(const CellsView& polygons, int64_t first_cell) {
    std::vector<int64_t> ids;
    for (const bool far : {false, true})
      for (size_t c = 0; c < polygons.count; ++c) {
        ids.clear();
        for (size_t i = 0; i < polygons.size(c); ++i) ids.push_back(polygons.point(c, i) + (far ? points_ : 0));
        if (faces_along(polygons, c) != far) std::reverse(ids.begin(), ids.end());
        polygons_.add(ids, first_cell + int64_t(c));
      }
  }

  // Edges of one polygon alone.
  void add_walls(const CellsView& polygons, int64_t first_cell) {
    struct Edge {
      int64_t lo, hi;
      size_t cell;
      bool forward;  // from lo to hi
    };
    std::vector<Edge> edges;
    for (size_t c = 0; c < polygons.count; ++c)
      for (size_t i = 0, k = polygons.size(c); i < k; ++i) {
        const int64_t a = polygons.point(c, i), b = polygons.point(c, (i + 1) % k);
        if (a != b) edges.push_back({std::min(a, b), std::max(a, b), c, a < b});
      }
    std::stable_sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return std::tie(a.lo, a.hi) < std::tie(b.lo, b.hi); });
    std::vector<Edge> borders;
    for (size_t i = 0, j = 0; i < edges.size(); i = j) {
      for (j = i + 1; j < edges.size() && edges[j].lo == edges[i].lo && edges[j].hi == edges[i].hi;) ++j;
      if (j == i + 1) borders.push_back(edges[i]);
    }
    std::stable_sort(borders.begin(), borders.end(), [](const Edge& a, const Edge& b) { return a.cell < b.cell; });
    for (const Edge& e : borders) {
      const bool from_lo = e.forward == faces_along(polygons, e.cell);
      wall(from_lo ? e.lo : e.hi, from_lo ? e.hi : e.lo, first_cell + int64_t(e.cell));
    }
  }

  Points twice() const {
    const Array& xyz = mesh_.points.xyz;
    Points r;
    r.origin = mesh_.points.origin;
    const size_t n = xyz.count();
    if (xyz.type() == ElementType::f64) r.xyz = moved<double>(n);
    else r.xyz = moved<float>(n);
    return r;
  }
  template <class T>
  Array moved(size_t n) const {
    T* to = nullptr;
    Array r = Array::make<T>(2 * n, 3, &to);
    for (size_t i = 0; i < 2 * n; ++i)
      for (int c = 0; c < 3; ++c) to[3 * i + size_t(c)] = T(mesh_.points.xyz.get(i % n, c) + (i < n ? 0 : shift_[c]));
    return r;
  }

  const SurfaceMesh& mesh_;
  int64_t points_;
  PointReader at_;
  Vec3 shift_;
  bool caps_;
  CellList lines_, polygons_;
};

}  // namespace

DatasetPtr extrude(const DatasetPtr& in, const ExtrudeParams& p, Context& ctx) {
  const Box3 box = bounds_over_all(*in, ctx);
  if (box.empty()) return surface_of(in, ctx);
  const Vec3 direction = p.direction ? *p.direction : chosen_direction(box);
  const double size = length(direction), far = p.length ? *p.length : round_near(0.1 * box.diagonal(), 0.03 * box.diagonal());
  if (!(size > 0) || !std::isfinite(size))
    fail_usage("the direction is zero or not finite", "extrude direction", "give one, e.g. direction=0,0,1");
  if (!std::isfinite(far) || far == 0) fail_usage("the length is zero or not finite", "extrude length");
  if (!p.length) ctx.info(fmt::format("extrude: by {}", short_number(far)));
  const DatasetPtr surface = surface_of(in, ctx);
  const SurfaceMesh& mesh = *surface->as<SurfaceMesh>();
  if (mesh.strips.size() > 0)
    fail_usage("strips of triangles are not drawn out", "extrude", "make triangles of them before: -f tessellate");
  if (mesh.points.xyz.count() > size_t(INT32_MAX) / 2) fail_usage("the surface has more than 2^30 points", "extrude");
  Extruder extruder(mesh, direction * (far / size), p.caps);
  DatasetParts out = surface->parts();
  out.mesh = extruder.run();
  std::vector<int64_t> points(2 * surface->point_count());
  for (size_t i = 0; i < points.size(); ++i) points[i] = int64_t(i % surface->point_count());
  std::vector<int64_t> cells = extruder.sources();
  out.point_ghost = {}, out.cell_ghost = {}, out.fields = {};
  carry_gathered(out.fields, surface->fields(), Association::point, points, Association::point);
  carry_gathered(out.fields, surface->fields(), Association::cell, cells, Association::cell);
  carry_whole(out.fields, surface->fields());
  FieldSet kept;
  for (const Field& f : out.fields)
    if (f.role != Role::normals && f.name != "original_cell") kept.add(f);
  kept.add(id_field("original_cell", Association::cell, std::move(cells)));
  out.fields = std::move(kept);
  return make_dataset(std::move(out));
}

}  // namespace sg
