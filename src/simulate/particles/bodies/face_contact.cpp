// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/bodies/face_contact.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/cells/mesh_dimension.h"
#include "filter/mesh/surface.h"
#include "filter/surface/polygons.h"

namespace sg::swarm {

namespace {

constexpr size_t pieces_at_once = 256;
constexpr double slack = 1e-6;  // of a face or edge, beyond its border: nothing slips through between two

constexpr double touching = 1e-3;  // of the gap: what is nearer does not say on which side

double determinant_of(const Vec3& a, const Vec3& b, const Vec3& c) { return dot(a, cross(b, c)); }

// Three directions that change evenly with time; they lie in a plane where their determinant, a cubic, is 0.
struct Moving {
  Vec3 a0, da, b0, db, c0, dc;

  std::array<double, 4> cubic() const {
    return {determinant_of(a0, b0, c0), determinant_of(da, b0, c0) + determinant_of(a0, db, c0) + determinant_of(a0, b0, dc),
            determinant_of(da, db, c0) + determinant_of(da, b0, dc) + determinant_of(a0, db, dc), determinant_of(da, db, dc)};
  }
};

// Calls f(t) for the roots of a cubic in [0, 1] in ascending order, until it returns true; returns whether it did.
template <class F>
bool each_root(const std::array<double, 4>& c, F&& f) {
  // Bernstein's coefficients bound it.
  const double b[4] = {c[0], c[0] + c[1] / 3, c[0] + (2 * c[1] + c[2]) / 3, c[0] + c[1] + c[2] + c[3]};
  if ((b[0] > 0 && b[1] > 0 && b[2] > 0 && b[3] > 0) || (b[0] < 0 && b[1] < 0 && b[2] < 0 && b[3] < 0)) return false;
  const auto value = [&](double t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); };
  double ends[4] = {0, 0, 0, 1};  // between them it rises or falls throughout
  int n = 1;
  const double p = c[2] / (3 * c[3]), q = c[1] / (3 * c[3]);
  if (c[3] != 0 && std::isfinite(p) && std::isfinite(q)) {
    if (const double under = p * p - q; under > 0) {
      const double r = -p - std::copysign(std::sqrt(under), p), s = r != 0 ? q / r : 0;
      for (const double t : {std::min(r, s), std::max(r, s)})
        if (t > 0 && t < 1) ends[n++] = t;
    }
  } else if (c[2] != 0) {
    if (const double t = -c[1] / (2 * c[2]); t > 0 && t < 1) ends[n++] = t;
  }
  ends[n] = 1;
  for (int i = 0; i < n; ++i) {
    double lo = ends[i], hi = ends[i + 1];
    const double at_lo = value(lo), at_hi = value(hi);
    if ((at_lo > 0 && at_hi > 0) || (at_lo < 0 && at_hi < 0)) continue;
    for (int k = 0; k < 60 && lo < hi; ++k) {
      const double middle = (lo + hi) / 2;
      if (middle <= lo || middle >= hi) break;
      ((value(middle) > 0) == (at_lo > 0) ? lo : hi) = middle;
    }
    if (f((lo + hi) / 2)) return true;
  }
  return false;
}

Vec3 between(const Vec3& a, const Vec3& b, double t) { return a + t * (b - a); }

Box3 grown(Box3 box, double by) {
  box.lo -= by * Vec3(1, 1, 1), box.hi += by * Vec3(1, 1, 1);
  return box;
}

}  // namespace

FaceContact::FaceContact(const DatasetPtr& cloth, const std::vector<DatasetPtr>& surfaces, Bounce bounce, const std::string& who,
                         Context& context)
    : bounce_(bounce), gap_(1e-6 * cloth->bounds().diagonal()) {
  for (const DatasetPtr& s : surfaces) {
    if (mesh_dimension(*s) < 2) continue;
    const DatasetPtr triangles = surface::triangle_surface(s, who, context);
    const SurfaceMesh& mesh = *triangles->as<SurfaceMesh>();
    const auto first = uint32_t(points_.size());
    for (const Vec3& p : surface::positions(mesh.points)) points_.push_back(p);
    const std::vector<uint32_t> ids = edges_of(mesh);
    for (size_t i = 0; i + 1 < ids.size(); i += 2) their_edges_.push_back({first + ids[i], first + ids[i + 1]});
  }
  if (points_.empty()) return;
  const auto add_face = [&](int64_t a, int64_t b, int64_t c) { faces_.push_back({uint32_t(a), uint32_t(b), uint32_t(c)}); };
  if (const auto* mesh = cloth->as<SurfaceMesh>()) {
    const Triangles t = triangles_of(*mesh);
    for (size_t i = 0; i + 2 < t.indices.size(); i += 3) add_face(t.indices[i], t.indices[i + 1], t.indices[i + 2]);
  } else {
    CellReader reader(cloth);
    for (size_t c = 0; c < cloth->cell_count(); ++c) {
      reader.open(c);
      const auto ids = reader.ids();
      for (size_t i = 2; reader.dimension() == 2 && i < ids.size(); ++i) add_face(ids[0], ids[i - 1], ids[i]);
    }
  }
  for (const auto& f : faces_)
    for (size_t k = 0; k < 3; ++k) edges_.push_back({std::min(f[k], f[(k + 1) % 3]), std::max(f[k], f[(k + 1) % 3])});
  std::sort(edges_.begin(), edges_.end());
  edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
  std::vector<Box3> boxes;
  for (const Vec3& p : points_) boxes.push_back({p, p});
  point_grid_ = BoxGrid(std::move(boxes));
  boxes.clear();
  for (const auto& e : their_edges_) {
    Box3 b;
    b.add(points_[e[0]]), b.add(points_[e[1]]);
    boxes.push_back(b);
  }
  edge_grid_ = BoxGrid(std::move(boxes));
}

// On which side the cloth is, by how far it was from what it meets when the step began, and is when it ends; 0: it meets nothing.
double FaceContact::side(double first, double last, bool end) const {
  if (end && std::abs(last) > gap_ / 2) return 0;
  if (end && std::abs(last) > touching * gap_) return last;
  return std::abs(first) > touching * gap_ ? first : 0;
}

void FaceContact::meet_face(std::span<const Vec3> x0, std::span<const Vec3> x1, size_t face, std::vector<uint32_t>& near,
                            std::vector<Contact>& out) const {
  const auto& ids = faces_[face];
  Box3 way;
  for (const uint32_t i : ids) way.add(x0[i]), way.add(x1[i]);
  point_grid_.find(grown(way, gap_), near);
  const Vec3 a0 = x0[ids[0]], da = x1[ids[0]] - a0;
  const Vec3 e0 = x0[ids[1]] - a0, de = x1[ids[1]] - x1[ids[0]] - e0, f0 = x0[ids[2]] - a0, df = x1[ids[2]] - x1[ids[0]] - f0;
  for (const uint32_t n : near) {
    const Vec3 p = points_[n], q0 = p - a0, dq = -da;
    // At a time: whether the point is on the face, or at the end within half of the gap of it.
    const auto met = [&](double t, bool end) {
      const Vec3 e = e0 + t * de, f = f0 + t * df, q = q0 + t * dq, normal = cross(e, f);
      const double area2 = dot(normal, normal);
      if (!(area2 > 0)) return false;
      const double v = determinant_of(q, f, normal) / area2, w = determinant_of(e, q, normal) / area2, u = 1 - v - w;
      if (!(u >= -slack && v >= -slack && w >= -slack)) return false;
      const Vec3 unit = normal * (1 / std::sqrt(area2));
      const auto off = [&](std::span<const Vec3> x) { return dot(u * x[ids[0]] + v * x[ids[1]] + w * x[ids[2]] - p, unit); };
      const double came = side(off(x0), off(x1), end);
      if (came == 0) return false;
      out.push_back({ids, {u, v, w}, p, came < 0 ? -unit : unit});
      return true;
    };
    if (!each_root(Moving{e0, de, f0, df, q0, dq}.cubic(), [&](double t) { return met(t, false); })) met(1, true);
  }
}

void FaceContact::meet_edge(std::span<const Vec3> x0, std::span<const Vec3> x1, size_t edge, std::vector<uint32_t>& near,
                            std::vector<Contact>& out) const {
  const auto& ids = edges_[edge];
  Box3 way;
  for (const uint32_t i : ids) way.add(x0[i]), way.add(x1[i]);
  edge_grid_.find(grown(way, gap_), near);
  const Vec3 a0 = x0[ids[0]], da = x1[ids[0]] - a0, e0 = x0[ids[1]] - a0, de = x1[ids[1]] - x1[ids[0]] - e0;
  for (const uint32_t n : near) {
    const Vec3 p = points_[their_edges_[n][0]], r = points_[their_edges_[n][1]] - p;
    const auto met = [&](double t, bool end) {
      // Where the lines are nearest: they meet there, all but for rounding.
      const Vec3 a = a0 + t * da, e = e0 + t * de, across = cross(e, r);
      const double size2 = dot(across, across);
      if (!(size2 > 1e-20 * dot(e, e) * dot(r, r))) return false;  // along each other: then ends meet faces
      const double s = determinant_of(p - a, r, across) / size2, u = determinant_of(p - a, e, across) / size2;
      if (!(s >= -slack && s <= 1 + slack && u >= -slack && u <= 1 + slack)) return false;
      const Vec3 unit = across * (1 / std::sqrt(size2)), at = p + u * r;
      const auto off = [&](std::span<const Vec3> x) { return dot(between(x[ids[0]], x[ids[1]], s) - at, unit); };
      const double came = side(off(x0), off(x1), end);
      if (came == 0) return false;
      out.push_back({{ids[0], ids[1], ids[1]}, {1 - s, s, 0}, at, came < 0 ? -unit : unit});
      return true;
    };
    if (!each_root(Moving{e0, de, r, {}, p - a0, -da}.cubic(), [&](double t) { return met(t, false); })) met(1, true);
  }
}

bool FaceContact::push_back(std::span<const Vec3> x0, std::span<const Vec3> v0, std::span<Vec3> x1, std::span<Vec3> v1,
                            std::span<const uint8_t> held, bool stop, std::vector<uint8_t>& moved, const Context& context) const {
  const size_t pieces = faces_.size() + edges_.size();
  std::vector<std::vector<Contact>> found((pieces + pieces_at_once - 1) / pieces_at_once);
  parallel_for(
      pieces, pieces_at_once,
      [&](size_t begin, size_t end) {
        std::vector<uint32_t> near;
        for (size_t i = begin; i < end; ++i)
          if (i < faces_.size()) meet_face(x0, x1, i, near, found[begin / pieces_at_once]);
          else meet_edge(x0, x1, i - faces_.size(), near, found[begin / pieces_at_once]);
      },
      &context);
  bool any = false;
  for (const std::vector<Contact>& list : found)
    for (const Contact& c : list) {
      double share = 0;
      Vec3 at, before, after;
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t i = c.point[k];
        const double w = c.weight[k];
        at += w * x1[i], before += w * v0[i], after += w * v1[i];
        if (!held[i]) share += w * w;
      }
      if (!(share > 0)) continue;
      if (stop) {
        for (const uint32_t i : c.point) any = any || x1[i] != x0[i], x1[i] = x0[i], v1[i] = {}, moved[i] = 1;
        continue;
      }
      any = true;
      const double lacks = gap_ - dot(at - c.at, c.normal), into = dot(after, c.normal);
      // What comes fast bounces, what lay on it stays.
      const double wanted = bounce_.restitution * std::max(0.0, -dot(before, c.normal)), pressed = std::max(0.0, wanted - into);
      const Vec3 along = after - into * c.normal;
      const double speed = length(along), slowed = speed > 0 ? std::min(1.0, bounce_.friction * pressed / speed) : 0;
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t i = c.point[k];
        if (held[i] || c.weight[k] == 0) continue;
        const double by = c.weight[k] / share;
        if (lacks > 0) x1[i] += by * lacks * c.normal;
        v1[i] += by * (pressed * c.normal - slowed * along), moved[i] = 1;
      }
    }
  return any;
}

}  // namespace sg::swarm
