// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/feature_edges.h"

#include <numbers>

#include "base/error.h"
#include "data/field_ops.h"
#include "filter/mesh/append.h"
#include "filter/scalar/contour/contour.h"
#include "filter/surface/normals.h"
#include "filter/surface/polygons.h"

namespace sg {

namespace {

using namespace surface;

using std::numbers::pi;

// Chosen edges as lines; `polygon` of each gives its cell fields.
struct EdgeLines {
  std::vector<int64_t> ids, polygon;
  std::vector<uint8_t> kind;
  std::vector<double> angle;

  void add(const Edges& edges, size_t e, uint8_t what, double bend) {
    ids.push_back(edges.lo[e]), ids.push_back(edges.hi[e]);
    polygon.push_back(edges.of(e)[0].polygon);
    kind.push_back(what), angle.push_back(bend);
  }
};

DatasetPtr lines_dataset(const Dataset& s, EdgeLines lines, bool with_angle) {
  const SurfaceMesh& mesh = *s.as<SurfaceMesh>();
  std::vector<int64_t> number(mesh.points.count(), -1), points;
  for (int64_t id : lines.ids) number[size_t(id)] = 0;
  for (size_t i = 0; i < number.size(); ++i)
    if (number[i] == 0) number[i] = int64_t(points.size()), points.push_back(int64_t(i));
  for (int64_t& id : lines.ids) id = number[size_t(id)];
  const auto first = int64_t(mesh.vertices.size() + mesh.lines.size());
  for (int64_t& c : lines.polygon) c += first;
  DatasetParts out;
  SurfaceMesh r;
  r.points = gather_points(mesh.points, points);
  r.lines = {id_array(lines.ids), {}, 2};
  carry_gathered(out.fields, s.fields(), Association::point, points, Association::point);
  carry_gathered(out.fields, s.fields(), Association::cell, lines.polygon, Association::cell);
  carry_whole(out.fields, s.fields());
  out.fields.add({"edge type", Association::cell, Array::from_vector(std::move(lines.kind)), "", Role::labels});
  if (with_angle) out.fields.add({"angle", Association::cell, Array::from_vector(std::move(lines.angle)), "deg", Role::none});
  out.mesh = std::move(r);
  out.notes = s.notes();
  out.time = s.time();
  return make_dataset(std::move(out));
}

// Degrees by which the surface bends at an edge of two polygons, whichever way round they are.
double bend(std::span<const Edges::Use> u, const std::vector<Vec3>& area) {
  const Vec3 m = area[u[0].polygon], n = u[0].forward == u[1].forward ? -area[u[1].polygon] : area[u[1].polygon];
  if (m == Vec3() || n == Vec3()) return 0;
  return std::atan2(length(cross(m, n)), dot(m, n)) * 180 / pi;
}

}  // namespace

DatasetPtr feature_edges(const DatasetPtr& in, const FeatureEdgesParams& p, Context& ctx) {
  const DatasetPtr s = polygon_surface(in, "feature_edges", ctx);
  const SurfaceMesh& mesh = *s->as<SurfaceMesh>();
  const CellsView polygons = cells_view(mesh.polygons);
  const std::vector<Vec3> at = positions(mesh.points);
  const Edges edges = edges_of_polygons(polygons, at.size());
  const std::vector<Vec3> area = vector_areas(polygons, at);
  EdgeLines lines;
  for (size_t e = 0; e < edges.size(); ++e) {
    if (e % 65536 == 0) ctx.check();
    const auto u = edges.of(e);
    if (u.size() == 2) {
      const double b = bend(u, area);
      const bool sharp = b > p.angle;
      if (sharp && p.feature) lines.add(edges, e, edge_feature, b);
      else if (!sharp && p.manifold) lines.add(edges, e, edge_manifold, b);
    } else if (u.size() == 1 ? p.boundary : p.non_manifold) {
      lines.add(edges, e, u.size() == 1 ? edge_boundary : edge_non_manifold, std::nan(""));
    }
  }
  if (lines.kind.empty()) ctx.info("feature_edges: there are no such edges");
  return lines_dataset(*s, std::move(lines), true);
}

namespace {

// Along edges: one polygon is seen from the front, the other from behind.
DatasetPtr edge_silhouette(const DatasetPtr& s, const SilhouetteParams& p) {
  const SurfaceMesh& mesh = *s->as<SurfaceMesh>();
  const CellsView polygons = cells_view(mesh.polygons);
  const std::vector<Vec3> at = positions(mesh.points), area = vector_areas(polygons, at);
  const Edges edges = edges_of_polygons(polygons, at.size());
  EdgeLines lines;
  for (size_t e = 0; e < edges.size(); ++e) {
    const auto u = edges.of(e);
    if (u.size() == 1 && p.boundary) lines.add(edges, e, edge_boundary, 0);
    if (u.size() != 2) continue;
    const Vec3 view = p.from ? *p.from - at[edges.lo[e]] : p.direction;
    const double sign = u[0].forward == u[1].forward ? -1 : 1;
    const double a = dot(area[u[0].polygon], view), b = sign * dot(area[u[1].polygon], view);
    if ((a >= 0) != (b >= 0)) lines.add(edges, e, 4, 0);
  }
  return lines_dataset(*s, std::move(lines), false);
}

// Field g = n.(viewer - x) on the points, contoured at 0.
DatasetPtr zero_set(const DatasetPtr& surface, const SilhouetteParams& p, Context& ctx) {
  const Field* normal = surface->fields().with_role(Role::normals);
  DatasetPtr s = surface;
  if (!normal || normal->association != Association::point || normal->components() != 3) {
    s = normals(surface, {.feature_angle = 180, .orient = Facing::consistent}, ctx);
    normal = &s->fields().require("Normals", Association::point);
  }
  const std::string normals_name = normal->name;
  s = triangle_surface(s, "silhouette", ctx);
  normal = &s->fields().require(normals_name, Association::point);
  const std::vector<Vec3> at = positions(s->as<SurfaceMesh>()->points);
  std::vector<double> g(at.size());
  for (size_t i = 0; i < g.size(); ++i) {
    const Vec3 n(normal->array.get(i, 0), normal->array.get(i, 1), normal->array.get(i, 2));
    g[i] = dot(n, p.from ? *p.from - at[i] : p.direction);
  }
  DatasetParts parts = s->parts();
  constexpr const char* name = "silhouette function";
  parts.fields.add({name, Association::point, Array::from_vector(std::move(g)), "", Role::none});
  ContourParams c;
  c.field.name = name;
  c.values = {0};
  DatasetParts found = contour(make_dataset(std::move(parts)), c, ctx)->parts();
  found.fields.remove(name, Association::point);
  const size_t n = std::get<SurfaceMesh>(found.mesh).cell_count();
  found.fields.add({"edge type", Association::cell, Array::from_vector(std::vector<uint8_t>(n, 4)), "", Role::labels});
  return make_dataset(std::move(found));
}

}  // namespace

DatasetPtr silhouette(const DatasetPtr& in, const SilhouetteParams& p, Context& ctx) {
  if (!p.from && !(length(p.direction) > 0 && std::isfinite(length(p.direction))))
    fail_usage("the direction has no length", "silhouette direction", "write e.g. direction=0,0,1");
  const DatasetPtr s = polygon_surface(in, "silhouette", ctx);
  if (!p.smooth || s->as<SurfaceMesh>()->polygons.size() == 0) return edge_silhouette(s, p);
  const DatasetPtr lines = zero_set(s, p, ctx);
  if (!p.boundary) return lines;
  FeatureEdgesParams only;
  only.feature = only.non_manifold = false;
  DatasetParts border = feature_edges(s, only, ctx)->parts();
  border.fields.remove("angle", Association::cell);
  return append({Data(lines), Data(make_dataset(std::move(border)))}, {.all = false, .part = false}, ctx);
}

}  // namespace sg
