// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/surface_zeros.h"

#include <algorithm>

#include "base/parallel.h"
#include "data/cell_reader.h"
#include "data/cell_topology.h"

namespace sg {

namespace {

struct Triangle {
  std::array<int64_t, 3> id;
  std::array<Vec3, 3> at;
  int64_t cell;
};

std::vector<Triangle> triangles_of_cells(const DatasetPtr& d, Context& context) {
  CellReader reader(d);
  std::vector<Triangle> out;
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
      for (size_t i = 0; i < 3; ++i) x.id[i] = reader.ids()[t[k + i]], x.at[i] = reader.at()[t[k + i]];
      x.cell = int64_t(c);
      out.push_back(x);
    }
  }
  return out;
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
  Surface(const FlowField& flow, Context& context) : triangles_(triangles_of_cells(flow.dataset(), context)) {
    const size_t n = flow.dataset()->point_count();
    normal_.resize(n), v_.resize(n), zero_.assign(n, 0);
    for (const Triangle& t : triangles_)
      for (size_t k = 0; k < 3; ++k) {
        const Vec3 a = t.at[(k + 1) % 3] - t.at[k], b = t.at[(k + 2) % 3] - t.at[k], across = cross(a, b);
        normal_[size_t(t.id[k])] += normalize(across) * std::atan2(length(across), dot(a, b));
      }
    for (size_t i = 0; i < n; ++i) {
      const Vec3 m = normal_[i] = normalize(normal_[i]), v = flow.at_point(i);
      // Kept along the surface; what is left of rounding alone counts as zero.
      v_[i] = v - m * dot(m, v);
      if (length(v_[i]) <= 1e-12 * std::max(length(v), flow.largest_speed() * 1e-3)) {
        zero_[i] = 1;
        const Vec3 aside = std::abs(m.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        v_[i] = normalize(cross(m, aside)) * (1e-9 * std::max(flow.largest_speed(), 1e-300));
      }
    }
  }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  Vec3 normal(size_t point) const { return normal_[point]; }
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
      const Vec3 from = turned(v_[i], normal_[i], normal_[j]), to = v_[j];
      sum += std::atan2(dot(normal_[j], cross(from, to)), dot(from, to));
    }
    return int(std::lround((sum + sphere_area(n[0], n[1], n[2])) / (2 * M_PI)));
  }

  // The zero of the interpolant in the triangle's plane, moved into it; its gradient.
  CriticalPoint point(const Triangle& t, double centre, Vec3& normal) const {
    const Vec3 a = t.at[1] - t.at[0], b = t.at[2] - t.at[0], across = cross(a, b);
    normal = normalize(across);
    const Vec3 e1 = normalize(a), e2 = cross(normal, e1);
    Vec3 v[3];
    for (size_t k = 0; k < 3; ++k) {
      Vec3 m = normal_[size_t(t.id[k])];
      v[k] = turned(v_[size_t(t.id[k])], m, normal);
    }
    CriticalPoint c;
    const Vec3 p = v[1] - v[0], q = v[2] - v[0];
    const double det = dot(normal, cross(p, q));
    double r = 1.0 / 3, s = 1.0 / 3;
    if (det != 0) r = dot(normal, cross(q, v[0])) / det, s = dot(normal, cross(v[0], p)) / det;
    r = std::clamp(r, 0.0, 1.0), s = std::clamp(s, 0.0, 1.0);
    if (r + s > 1) r /= r + s, s = 1 - r;
    c.at = t.at[0] + r * a + s * b;
    c.cell = t.cell;
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
  std::vector<Vec3> normal_, v_;
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

void find_surface_zeros(const FlowField& flow, const CriticalOptions& options, CriticalPoints& out, Context& context) {
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
      for (const int64_t id : t.id) fastest = std::max(fastest, length(flow.at_point(size_t(id))));
      if (fastest < options.min_speed * flow.largest_speed()) continue;
      Vec3 normal;
      CriticalPoint c = surface.point(t, centre, normal);
      for (size_t k = 0; k < 3; ++k)
        if (surface.zero(t, k)) {
          c.at = t.at[k];
          mean_gradient(surface, t.id[k], centre, c, normal);
        }
      c.index = index;
      if (c.flow.index != index) c.flow.type = CriticalType::degenerate;
      out.points.push_back(c), out.normal.push_back(normal);
    }
  }
}

}  // namespace sg
