// SPDX-License-Identifier: Apache-2.0
#include "index/cell_probe.h"

#include <algorithm>

#include "data/cells/cell_topology.h"
#include "index/triangle.h"

namespace sg {

SimplexArrays::SimplexArrays(const Dataset& dataset) {
  const Points* points = nullptr;
  if (const auto* u = dataset.as<UnstructuredMesh>()) {
    points = &u->points;
    cells = cells_view(u->cells);
    if (u->types.empty()) single = u->single_type;
    else types = u->types.view<uint8_t>().data;
  } else if (const auto* s = dataset.as<SurfaceMesh>(); s && s->polygons.fixed == 3) {
    points = &s->points;
    cells = cells_view(s->polygons);
    first = s->vertices.size() + s->lines.size();
    single = CellType::triangle;
  }
  if (types && cells.count > 0 && (types[0] == uint8_t(CellType::tetra) || types[0] == uint8_t(CellType::triangle)) &&
      std::all_of(types, types + cells.count, [&](uint8_t t) { return t == types[0]; })) {
    single = CellType(types[0]);
    types = nullptr;
  }
  if (!points || points->count() == 0) {
    cells = {};
    return;
  }
  const Box3 b = dataset.bounds();
  for (int a = 0; a < 3; ++a) ease = std::max({ease, std::abs(b.lo[a]), std::abs(b.hi[a])});
  ease = std::isfinite(ease) ? 4 * std::numeric_limits<double>::epsilon() * ease : 0;
  keep = points->xyz.made_packed();
  origin = points->origin;
  if (keep.type() == ElementType::f32) f32 = keep.view<float>().data;
  else f64 = keep.view<double>().data;
}

namespace {

Vec3 at_triangle(Vec2 r, Vec3 a, Vec3 b, Vec3 c) { return a + (b - a) * r.x + (c - a) * r.y; }

// Corners of the linear simplex, or none.
int simplex_corners(const SimplexArrays& s, size_t cell, int64_t ids[4], Vec3 p[4]) {
  const CellType t = s.type(cell);
  const int n = t == CellType::tetra ? 4 : t == CellType::triangle ? 3 : 0;
  for (int k = 0; k < n; ++k) p[k] = s.point(ids[k] = s.id(cell, k));
  return n;
}

constexpr uint8_t tetra_faces[4][3] = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}};

// The corners sorted by id: t is then the same from both sides of a face.
double hit_sorted(const TriangleRay& ray, const int64_t* ids, const Vec3* at, uint32_t a, uint32_t b, uint32_t c) {
  if (ids[a] > ids[b]) std::swap(a, b);
  if (ids[b] > ids[c]) std::swap(b, c);
  if (ids[a] > ids[b]) std::swap(a, b);
  return ray.hit(at[a], at[b], at[c]);
}

struct Hits {
  const TriangleRay& ray;
  double t0, t1, best = NAN;
  Vec3 normal{0, 0, 0};
  void test(const int64_t* ids, const Vec3* at, uint32_t a, uint32_t b, uint32_t c) {
    const double t = hit_sorted(ray, ids, at, a, b, c);
    if (!(t >= t0 && t <= t1) || t >= best) return;
    best = t, normal = cross(at[b] - at[a], at[c] - at[a]);
  }
};

}  // namespace

double locate_slack(const Dataset& dataset) {
  const double s = 1e-6 * dataset.bounds().diagonal();
  return std::isfinite(s) ? s : 0;
}

namespace {

// Per axis, how far a point of a curved cell may lie from its corners' interpolation at the same reference coordinates; false where that is
// not known.
bool curvature(const CellReader& reader, Vec3& bound) {
  const CellType type = reader.type(), corner_type = linear_type(type);
  const auto at = reader.at();
  const size_t corners = size_t(std::max(cell_type_info(corner_type).corners, 0));
  const CellShape* shape = CellShape::find(type, at.size(), reader.orders());
  const CellShape* straight = CellShape::find(corner_type, corners);
  if (!shape || !straight || corners > 8 || corners > at.size()) return false;
  Vec3 deviation;
  for (size_t k = corners; k < at.size(); ++k) {
    double n[8];
    straight->values(shape->node(k), n);
    Vec3 p;
    for (size_t c = 0; c < corners; ++c) p += at[c] * n[c];
    for (int a = 0; a < 3; ++a) deviation[a] = std::max(deviation[a], std::abs(at[k][a] - p[a]));
  }
  // Largest sum of the absolute shape functions that do not belong to corners: 1.5 for the quadratic tetrahedron, at most 3 for all
  // quadratic types; else no more than the Lebesgue constant of equidistant nodes, per axis.
  constexpr double lebesgue[] = {1, 1, 1.25, 1.64, 2.21, 3.11, 4.55, 6.94, 10.95, 17.85, 29.9};
  int order = 2;
  for (int o : reader.orders()) order = std::max(order, o);
  bound = deviation * (order > 2 ? std::pow(lebesgue[std::min(order, 10)], reader.dimension()) : shape->nodes() == 10 ? 1.5 : 3.0);
  return true;
}

}  // namespace

Box3 cell_box(const CellReader& reader) {
  Box3 box;
  for (Vec3 p : reader.at()) box.add(p);
  const CellType type = reader.type();
  Vec3 bound;
  if (!is_high_order(type) || is_bezier(type) || !curvature(reader, bound)) return box;  // Bezier: in the hull of the nodes
  box.lo += -bound, box.hi += bound;
  return box;
}

namespace {

// A curved tetrahedron lies within its curvature of the flat one of its corners: whether x is beyond that on one of the sides. Spares the
// search that a solver needs to be sure that x is not inside.
bool beside_curved_tetra(const CellReader& reader, Vec3 x) {
  Vec3 bound;
  if (linear_type(reader.type()) != CellType::tetra || is_bezier(reader.type()) || !curvature(reader, bound)) return false;
  const auto p = reader.at();
  const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0], d = x - p[0];
  Vec3 side[4] = {Vec3(), cross(v, w), cross(w, u), cross(u, v)};
  const double volume = dot(u, side[1]);
  side[0] = -(side[1] + side[2] + side[3]);
  for (int m = 0; m < 4; ++m) {
    const double r = dot(d, side[m]) / volume + (m == 0 ? 1.0 : 0.0);
    const double reach = (std::abs(side[m].x) * bound.x + std::abs(side[m].y) * bound.y + std::abs(side[m].z) * bound.z) / std::abs(volume);
    if (r < -reach - 1e-6) return true;
  }
  return false;
}

}  // namespace

bool CellProbe::holds(size_t cell, Vec3 x, CellPlace& place) {
  int64_t ids[4];
  Vec3 p[4];
  const int n = simplex_corners(*fast_, cell, ids, p);
  if (n == 4) {
    place.rst = tetra_coordinates(x, p[0], p[1], p[2], p[3]);
    place.nearest = x, place.distance2 = 0, place.outside = 0;
    return in_tetra(place.rst, tetra_tolerance(fast_->ease, p[1] - p[0]));
  }
  if (n == 3) {
    const Vec2 r = nearest_in_triangle(x, p[0], p[1], p[2]);
    place.rst = {r.x, r.y, 0};
    place.nearest = at_triangle(r, p[0], p[1], p[2]);
    place.distance2 = dot(x - place.nearest, x - place.nearest), place.outside = 0;
    return place.distance2 <= slack_ * slack_;
  }
  CellMap& m = open(cell);
  const bool solid = m.dimension() == 3;
  const Box3 b = cell_box(m.reader());
  const Vec3 size = b.size();
  const double grow = solid ? 1e-7 * std::max({size.x, size.y, size.z}) : slack_;
  for (int a = 0; a < 3; ++a)
    if (!(x[a] >= b.lo[a] - grow && x[a] <= b.hi[a] + grow)) return false;
  if (solid && is_high_order(m.reader().type()) && beside_curved_tetra(m.reader(), x)) return false;
  const bool inside = m.locate(x, place, locate_tolerance);
  return solid ? inside : place.distance2 <= slack_ * slack_;
}

void CellProbe::weights(size_t cell, const CellPlace& place, std::vector<int64_t>& ids, std::vector<double>& out) {
  const CellType t = fast_->type(cell);
  if (t != CellType::empty) {
    const Vec3 r = place.rst;
    const size_t n = t == CellType::tetra ? 4 : 3;
    ids.resize(n), out.resize(n);
    for (size_t k = 0; k < n; ++k) ids[k] = fast_->id(cell, int(k));
    out[0] = 1 - r.x - r.y - r.z, out[1] = r.x, out[2] = r.y;
    if (n == 4) out[3] = r.z;
    return;
  }
  CellMap& m = open(cell);
  const auto from = m.reader().ids();
  ids.assign(from.begin(), from.end());
  out.resize(from.size());
  m.weights(place, out);
}

// The faces of the open cell as triangles. Bezier nodes do not lie on the cell: theirs are evaluated.
void CellProbe::make_triangles() {
  if (triangles_of_ == opened_) return;
  triangles_of_ = opened_;
  triangles_.clear();
  const CellReader& reader = map_.reader();
  const CellType type = reader.type();
  const auto at = reader.at();
  const auto ids = reader.ids();
  corners_.assign(at.begin(), at.end());
  if (is_bezier(type))
    if (const CellShape* shape = CellShape::find(type, at.size(), reader.orders()))
      for (size_t k = 0; k < corners_.size(); ++k) corners_[k] = map_.position(shape->node(k));
  if (reader.dimension() == 2) return tessellate_face(type, corners_, triangles_);
  if (reader.dimension() != 3) return;
  auto add_face = [&](CellType face_type, std::span<const uint32_t> nodes) {
    face_.clear(), part_.clear();
    ring_.assign(nodes.begin(), nodes.end());
    // From the smallest id on: both cells of a warped face cut it along the same diagonal.
    if (face_type == CellType::quad || face_type == CellType::polygon)
      std::rotate(ring_.begin(), std::min_element(ring_.begin(), ring_.end(), [&](uint32_t a, uint32_t b) { return ids[a] < ids[b]; }),
                  ring_.end());
    for (uint32_t k : ring_) face_.push_back(corners_[k]);
    tessellate_face(face_type, face_, part_);
    for (uint32_t k : part_) triangles_.push_back(ring_[k]);
  };
  if (type == CellType::polyhedron) {
    CellReader faces = reader;  // lists faces on demand
    for (size_t f = 0; f < faces.face_count(); ++f) add_face(CellType::polygon, faces.face(f));
  } else {
    const CellFaces& faces = cell_faces(type, at.size(), reader.orders());
    for (size_t f = 0; f < faces.size(); ++f) add_face(faces.type[f], faces.face(f));
  }
}

double CellProbe::nearest(size_t cell, Vec3 x, Vec3& at, double limit2) {
  int64_t ids[4];
  Vec3 p[4];
  CellPlace place;
  const int n = simplex_corners(*fast_, cell, ids, p);
  double best = HUGE_VAL;
  auto test = [&](Vec3 a, Vec3 b, Vec3 c) {
    const Vec3 q = at_triangle(nearest_in_triangle(x, a, b, c), a, b, c);
    const double d2 = dot(x - q, x - q);
    if (d2 < best) best = d2, at = q;
  };
  if (n == 3) {
    test(p[0], p[1], p[2]);
    return best;
  }
  if (n == 4) {
    if (holds(cell, x, place)) return at = x, 0;
    for (const auto& f : tetra_faces) test(p[f[0]], p[f[1]], p[f[2]]);
    return best;
  }
  CellMap& m = open(cell);
  const Box3 box = cell_box(m.reader());
  double apart2 = 0;
  for (int a = 0; a < 3; ++a) {
    const double d = std::max({box.lo[a] - x[a], x[a] - box.hi[a], 0.0});
    apart2 += d * d;
  }
  if (apart2 > limit2 * (1 + 1e-9)) return HUGE_VAL;
  if (m.dimension() == 3 && holds(cell, x, place)) return at = x, 0;
  m.nearest_outside(x, place);
  return at = place.nearest, place.distance2;
}

double CellProbe::hit(size_t cell, Vec3 x, Vec3 d, double t0, double t1, Vec3& normal) {
  int64_t ids[4];
  Vec3 p[4];
  const TriangleRay ray(x, d);
  Hits hits{ray, t0, t1};
  const int n = simplex_corners(*fast_, cell, ids, p);
  Vec3 center;
  bool solid = n == 4;
  if (n == 3) hits.test(ids, p, 0, 1, 2);
  if (n == 4) {
    for (const auto& f : tetra_faces) hits.test(ids, p, f[0], f[1], f[2]);
    center = (p[0] + p[1] + p[2] + p[3]) * 0.25;
  }
  if (n == 0) {
    open(cell);
    make_triangles();
    const auto all = map_.reader().ids();
    for (size_t i = 0; i + 2 < triangles_.size(); i += 3)
      hits.test(all.data(), corners_.data(), triangles_[i], triangles_[i + 1], triangles_[i + 2]);
    solid = map_.dimension() == 3;
    for (Vec3 c : corners_) center += c;
    if (!corners_.empty()) center = center / double(corners_.size());
  }
  if (std::isnan(hits.best)) return NAN;
  normal = normalize(hits.normal);
  if (solid && dot(normal, x + d * hits.best - center) < 0) normal = -normal;
  return hits.best;
}

}  // namespace sg
