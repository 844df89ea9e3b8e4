// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/zeros/surface_zeros.h"

#include <algorithm>
#include <array>
#include <map>

#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/cells/cell_topology.h"

namespace sg {

namespace {

struct Triangle {
  std::array<int64_t, 3> id;
  std::array<Vec3, 3> at;
  int64_t cell;
  int32_t part;
};

void triangles_of_cells(const DatasetPtr& d, int32_t part, int64_t first, std::vector<Triangle>& out, Context& context) {
  CellReader reader(d);
  std::vector<uint32_t> t;
  for (size_t c = 0; c < reader.count(); ++c) {
    if (c % 65536 == 0) context.check();
    if (reader.hidden(c)) continue;
    reader.open(c);
    if (reader.dimension() != 2) continue;
    t.clear();
    tessellate_face(reader.type(), reader.at(), t, reader.orders());
    for (size_t k = 0; k + 2 < t.size(); k += 3) {
      Triangle x;
      for (size_t i = 0; i < 3; ++i) x.id[i] = first + reader.ids()[t[k + i]], x.at[i] = reader.at()[t[k + i]];
      x.cell = int64_t(c), x.part = part;
      out.push_back(x);
    }
  }
}

// Which points are borders: a point inside has each neighbour once before and once behind it in the triangles around it.
std::vector<uint8_t> border_points(const std::vector<Triangle>& triangles, size_t n) {
  auto mixed = [](int64_t id) {
    uint64_t x = uint64_t(id) + 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u, x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  };
  std::vector<uint64_t> sum(n, 0);
  for (const Triangle& t : triangles)
    for (size_t k = 0; k < 3; ++k) sum[size_t(t.id[k])] += mixed(t.id[(k + 1) % 3]) - mixed(t.id[(k + 2) % 3]);
  std::vector<uint8_t> border(n);
  for (size_t i = 0; i < n; ++i) border[i] = sum[i] != 0;
  return border;
}

// Border points at one place become the first of them.
void weld(std::vector<Triangle>& triangles, size_t n) {
  const std::vector<uint8_t> border = border_points(triangles, n);
  std::map<std::array<double, 3>, int64_t> first;
  for (Triangle& t : triangles)
    for (size_t k = 0; k < 3; ++k)
      if (border[size_t(t.id[k])]) t.id[k] = first.try_emplace({t.at[k].x, t.at[k].y, t.at[k].z}, t.id[k]).first->second;
}

// The shortest rotation that takes unit vector a to b, applied to v.
Vec3 turned(Vec3 v, Vec3 a, Vec3 b) {
  const Vec3 axis = cross(a, b);
  const double c = dot(a, b);
  if (c < -0.999999) return v;
  return v * c + cross(axis, v) + axis * (dot(axis, v) / (1 + c));
}

// Signed area of the triangle of three unit vectors on the sphere.
double sphere_area(Vec3 a, Vec3 b, Vec3 c) { return 2 * std::atan2(dot(a, cross(b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a)); }

class Surface {
 public:
  Surface(const FlowParts& flow, Context& context) {
    for (size_t k = 0; k < flow.count(); ++k) {
      const FlowField& part = flow.fields()[k];
      triangles_of_cells(part.dataset(), int32_t(k), int64_t(given_.size()), triangles_, context);
      for (size_t i = 0; i < part.dataset()->point_count(); ++i) given_.push_back(part.at_point(i));
    }
    const size_t n = given_.size();
    weld(triangles_, n);
    normal_.resize(n), v_.resize(n), zero_.assign(n, 0);
    const double largest = flow.largest_speed();
    for (const Triangle& t : triangles_)
      for (size_t k = 0; k < 3; ++k) {
        const Vec3 a = t.at[(k + 1) % 3] - t.at[k], b = t.at[(k + 2) % 3] - t.at[k], across = cross(a, b);
        normal_[size_t(t.id[k])] += normalize(across) * std::atan2(length(across), dot(a, b));
      }
    for (size_t i = 0; i < n; ++i) {
      const Vec3 m = normal_[i] = normalize(normal_[i]), v = given_[i];
      // Kept along the surface; what is only rounding error counts as zero.
      v_[i] = v - m * dot(m, v);
      if (length(v_[i]) <= 1e-12 * std::max(length(v), largest * 1e-3)) {
        zero_[i] = 1;
        const Vec3 aside = std::abs(m.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        v_[i] = normalize(cross(m, aside)) * (1e-9 * std::max(largest, 1e-300));
      }
    }
  }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  Vec3 normal(size_t point) const { return normal_[point]; }
  Vec3 given(int64_t point) const { return given_[size_t(point)]; }
  bool zero(const Triangle& t, size_t k) const { return zero_[size_t(t.id[k])] != 0; }

  int zeros(const Triangle& t) const { return zero(t, 0) + zero(t, 1) + zero(t, 2); }
  bool has_values(const Triangle& t) const {
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 v = v_[size_t(t.id[k])];
      if (!std::isfinite(v.x + v.y + v.z) || length(normal_[size_t(t.id[k])]) < 0.5) return false;
    }
    return length(cross(t.at[1] - t.at[0], t.at[2] - t.at[0])) > 0;
  }

  int index(const Triangle& t) const {
    double sum = 0;
    Vec3 n[3];
    for (size_t k = 0; k < 3; ++k) {
      const auto i = size_t(t.id[k]), j = size_t(t.id[(k + 1) % 3]);
      n[k] = normal_[i];
      sum += i < j ? turning(i, j) : -turning(j, i);
    }
    return int(std::lround((sum + sphere_area(n[0], n[1], n[2])) / (2 * M_PI)));
  }

  // Of the velocity along an edge, always from the smaller number: velocities that are exactly opposite, about a zero on the edge or at
  // one of its ends, turn by half a circle to the left in one of its triangles and then to the right in the other.
  double turning(size_t i, size_t j) const {
    const Vec3 from = turned(v_[i], normal_[i], normal_[j]), to = v_[j];
    return std::atan2(dot(normal_[j], cross(from, to)), dot(from, to));
  }

  // The velocity of a corner in the plane of the triangle.
  Vec3 along(const Triangle& t, size_t k, Vec3 normal) const {
    return zero(t, k) ? Vec3() : turned(v_[size_t(t.id[k])], normal_[size_t(t.id[k])], normal);
  }

  // The zero of the interpolant in the triangle's plane, moved into it; its gradient.
  CriticalPoint point(const Triangle& t, double centre, Vec3& normal) const {
    const Vec3 a = t.at[1] - t.at[0], b = t.at[2] - t.at[0], across = cross(a, b);
    normal = normalize(across);
    const Vec3 e1 = normalize(a), e2 = cross(normal, e1);
    Vec3 v[3];
    for (size_t k = 0; k < 3; ++k) v[k] = turned(v_[size_t(t.id[k])], normal_[size_t(t.id[k])], normal);
    CriticalPoint c;
    const Vec3 p = v[1] - v[0], q = v[2] - v[0];
    const double det = dot(normal, cross(p, q));
    double r = 1.0 / 3, s = 1.0 / 3;
    if (det != 0) r = dot(normal, cross(q, v[0])) / det, s = dot(normal, cross(v[0], p)) / det;
    const Vec3 zero = t.at[0] + r * a + s * b;
    r = std::clamp(r, 0.0, 1.0), s = std::clamp(s, 0.0, 1.0);
    if (r + s > 1) r /= r + s, s = 1 - r;
    c.at = t.at[0] + r * a + s * b;
    c.moved = length(zero - c.at);
    c.cell = t.cell, c.part = t.part;
    c.size = std::max({length(a), length(b), length(a - b)});
    const double area2 = dot(across, across);
    const Vec3 ga = cross(b, across) / area2, gb = cross(across, a) / area2;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) c.gradient.m[i][j] = p[i] * ga[j] + q[i] * gb[j];
    c.flow = linearise_in_plane(c.gradient, e1, e2, centre);
    return c;
  }

 private:
  std::vector<Triangle> triangles_;
  std::vector<Vec3> given_, normal_, v_;
  std::vector<uint8_t> zero_;
};

// At a point of zero velocity: the mean gradient of its triangles, along the point's own tangents.
void mean_gradient(const Surface& s, int64_t id, double centre, CriticalPoint& c, Vec3& normal) {
  Mat3 sum;
  double weight = 0;
  for (auto& row : sum.m)
    for (double& e : row) e = 0;
  for (const Triangle& t : s.triangles()) {
    if (t.id[0] != id && t.id[1] != id && t.id[2] != id) continue;
    Vec3 n;
    const CriticalPoint one = s.point(t, centre, n);
    const double w = length(cross(t.at[1] - t.at[0], t.at[2] - t.at[0]));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sum.m[i][j] += w * one.gradient.m[i][j];
    weight += w;
  }
  normal = s.normal(size_t(id));
  for (auto& row : sum.m)
    for (double& e : row) e /= weight;
  c.gradient = sum;
  const Vec3 e1 = normalize(cross(normal, std::abs(normal.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
  c.flow = linearise_in_plane(sum, e1, cross(normal, e1), centre);
}

}  // namespace

void find_surface_zeros(const FlowParts& flow, const CriticalOptions& options, CriticalPoints& out, Context& context) {
  const double centre = options.centre;
  const Surface surface(flow, context);
  const auto& triangles = surface.triangles();
  constexpr size_t grain = 4096;
  struct Part {
    std::vector<std::pair<size_t, int>> found;
    size_t spread = 0;
    int sum = 0;
  };
  std::vector<Part> parts((triangles.size() + grain - 1) / grain);
  parallel_for(
      triangles.size(), grain,
      [&](size_t begin, size_t end) {
        Part& part = parts[begin / grain];
        for (size_t i = begin; i < end; ++i) {
          const Triangle& t = triangles[i];
          if (!surface.has_values(t)) continue;
          const int index = surface.index(t);
          part.sum += index;
          if (surface.zeros(t) > 1) ++part.spread;
          else if (index != 0) part.found.emplace_back(i, index);
        }
      },
      &context);
  out.faces_index = 0;
  for (const Part& part : parts) {
    out.spread += part.spread;
    *out.faces_index += part.sum;
    for (const auto& [i, index] : part.found) {
      const Triangle& t = triangles[i];
      double fastest = 0;
      for (const int64_t id : t.id) {
        const double speed = length(surface.given(id));
        fastest = std::max(fastest, speed);
      }
      if (fastest < options.min_speed * flow.largest_speed()) continue;
      Vec3 normal;
      CriticalPoint c = surface.point(t, centre, normal);
      for (size_t k = 0; k < 3; ++k)
        if (surface.zero(t, k)) {
          c.at = t.at[k], c.moved = 0;
          mean_gradient(surface, t.id[k], centre, c, normal);
        }
      c.index = index, c.speed = fastest;
      if (c.flow.index != index) c.flow.type = CriticalType::degenerate;
      out.points.push_back(c), out.normal.push_back(normal);
    }
  }
}

FlowParts tangential_flow(const FlowParts& flow, Context& context) {
  const Surface surface(flow, context);
  std::vector<double> xyz, v;
  std::vector<int64_t> ids, offsets{0};
  for (const Triangle& t : surface.triangles()) {
    if (!surface.has_values(t)) continue;
    const Vec3 normal = normalize(cross(t.at[1] - t.at[0], t.at[2] - t.at[0]));
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 u = surface.along(t, k, normal);
      ids.push_back(int64_t(xyz.size() / 3));
      xyz.insert(xyz.end(), {t.at[k].x, t.at[k].y, t.at[k].z}), v.insert(v.end(), {u.x, u.y, u.z});
    }
    offsets.push_back(int64_t(ids.size()));
  }
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.polygons.connectivity = Array::from_vector(std::move(ids));
  mesh.polygons.offsets = Array::from_vector(std::move(offsets));
  FieldSet fields;
  fields.add({"velocity", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  return FlowParts(FlowField(make_dataset(std::move(mesh), std::move(fields)), "velocity", context));
}

}  // namespace sg
