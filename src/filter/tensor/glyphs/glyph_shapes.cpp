// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/glyphs/glyph_shapes.h"

#include <algorithm>
#include <functional>

#include "base/error.h"

namespace sg {

namespace {

struct Axes {
  Vec3 x, y, z;    // right-handed; z is the axis of symmetry
  double a, b, c;  // half lengths along them
};

struct Linearity {
  double linear, planar;
};
// Of the absolute eigenvalues, sorted, by the trace.
Linearity linearity(const Eigen3& e) {
  double l[3] = {std::abs(e.value[0]), std::abs(e.value[1]), std::abs(e.value[2])};
  std::sort(l, l + 3, std::greater<>());
  const double t = l[0] + l[1] + l[2];
  return t > 0 ? Linearity{(l[0] - l[1]) / t, 2 * (l[1] - l[2]) / t} : Linearity{0, 0};
}

// The axis of the largest absolute eigenvalue for line-like tensors, of the smallest for disc-like ones.
Axes axes_of(const Eigen3& e, double factor, double min_ratio) {
  double r[3], most = 0;
  for (int k = 0; k < 3; ++k) r[k] = std::abs(e.value[k]), most = std::max(most, r[k]);
  for (double& v : r) v = factor * std::max(v, min_ratio * most);
  const Linearity l = linearity(e);
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (l.linear >= l.planar ? r[k] > r[axis] : r[k] <= r[axis]) axis = k;
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  return {e.vector[i], e.vector[j], e.vector[axis], r[i], r[j], r[axis]};
}

double power(double x, double p) { return x < 0 ? -std::pow(-x, p) : std::pow(x, p); }

Vec3 combine(const Axes& a, double x, double y, double z) { return a.x * x + a.y * y + a.z * z; }

}  // namespace

GlyphPattern::GlyphPattern(TensorShape shape, int resolution, double gamma, double min_ratio)
    : shape_(shape), rows_(std::max(resolution, 2)), gamma_(gamma), min_ratio_(min_ratio) {
  auto face = [&](std::initializer_list<int> corners) {
    ids_.insert(ids_.end(), corners.begin(), corners.end());
    offsets_.push_back(int32_t(ids_.size()));
  };
  if (shape_ == TensorShape::cuboid) {
    count_ = 24;
    for (int f = 0; f < 6; ++f) face({4 * f, 4 * f + 1, 4 * f + 2, 4 * f + 3});
  } else if (shape_ == TensorShape::cylinder) {
    const int m = 2 * rows_;
    count_ = size_t(4 * m);  // sides below, above; lids below, above
    for (int s = 0; s < m; ++s) face({s, (s + 1) % m, m + (s + 1) % m, m + s});
    for (int lid = 0; lid < 2; ++lid) {
      for (int s = 0; s < m; ++s) ids_.push_back((2 + lid) * m + (lid ? s : m - 1 - s));
      offsets_.push_back(int32_t(ids_.size()));
    }
  } else {
    sphere_faces();
  }
}

// Vertices: the pole, rows from it to the other one, the other pole.
void GlyphPattern::sphere_faces() {
  const int m = 2 * rows_, last = 1 + (rows_ - 1) * m;
  auto add = [&](int around, int down) {
    const double t = 2 * M_PI * around / m, p = M_PI * down / rows_;
    // Exact at the quarters, so that symmetric glyphs are.
    auto clean = [](double v) { return std::abs(v) < 1e-15 ? 0.0 : v; };
    angles_.push_back({clean(std::cos(t)), clean(std::sin(t)), clean(std::cos(p)), clean(std::sin(p))});
  };
  add(0, 0);
  for (int d = 1; d < rows_; ++d)
    for (int s = 0; s < m; ++s) add(s, d);
  add(0, rows_);
  count_ = angles_.size();
  auto id = [&](int d, int s) { return d == 0 ? 0 : d == rows_ ? last : 1 + (d - 1) * m + s % m; };
  for (int d = 0; d < rows_; ++d)
    for (int s = 0; s < m; ++s) {
      ids_.push_back(id(d, s));
      ids_.push_back(id(d + 1, s));
      if (d + 1 < rows_) ids_.push_back(id(d + 1, s + 1));
      if (d > 0) ids_.push_back(id(d, s + 1));
      offsets_.push_back(int32_t(ids_.size()));
    }
}

void GlyphPattern::make(const Eigen3& e, double factor, GlyphVertex* out) const {
  switch (shape_) {
    case TensorShape::cuboid: return make_cuboid(e, factor, out);
    case TensorShape::cylinder: return make_cylinder(e, factor, out);
    case TensorShape::reynolds:
    case TensorShape::hwy: return make_lobes(e, factor, out);
    default: return make_round(e, factor, out);
  }
}

// Superquadric with exponents alpha around and beta from pole to pole; 1 and 1 are the ellipsoid.
void GlyphPattern::make_round(const Eigen3& e, double factor, GlyphVertex* out) const {
  const Axes a = axes_of(e, factor, min_ratio_);
  double alpha = 1, beta = 1;
  if (shape_ == TensorShape::superquadric) {
    const Linearity l = linearity(e);
    const double p = std::pow(1 - l.planar, gamma_), q = std::pow(1 - l.linear, gamma_);
    alpha = l.linear >= l.planar ? p : q, beta = l.linear >= l.planar ? q : p;
  }
  for (size_t i = 0; i < count_; ++i) {
    const auto [ct, st, cp, sp] = angles_[i];
    const Vec3 at(power(ct, alpha) * power(sp, beta), power(st, alpha) * power(sp, beta), power(cp, beta));
    const Vec3 n(power(ct, 2 - alpha) * power(sp, 2 - beta), power(st, 2 - alpha) * power(sp, 2 - beta), power(cp, 2 - beta));
    out[i].at = combine(a, a.a * at.x, a.b * at.y, a.c * at.z);
    out[i].normal = normalize(combine(a, n.x / a.a, n.y / a.b, n.z / a.c));
    out[i].direction = normalize(combine(a, at.x, at.y, at.z));
  }
}

void GlyphPattern::make_lobes(const Eigen3& e, double factor, GlyphVertex* out) const {
  for (size_t i = 0; i < count_; ++i) {
    const auto [ct, st, cp, sp] = angles_[i];
    const double n[3] = {ct * sp, st * sp, cp};  // in the frame of the eigenvectors
    double normal_part = 0, square = 0;
    for (int k = 0; k < 3; ++k) normal_part += e.value[k] * n[k] * n[k], square += e.value[k] * e.value[k] * n[k] * n[k];
    const double shear = std::sqrt(std::max(0.0, square - normal_part * normal_part));
    const bool reynolds = shape_ == TensorShape::reynolds;
    const double r = reynolds ? std::abs(normal_part) : shear;
    Vec3 dir, normal;
    for (int k = 0; k < 3; ++k) {
      dir += e.vector[k] * n[k];
      // The normal of the surface r(n) n is r n less the gradient of r along the sphere.
      double slope = 0;
      if (reynolds) slope = (normal_part < 0 ? -2 : 2) * (e.value[k] - normal_part) * n[k];
      else if (shear > 0)
        slope = ((e.value[k] * e.value[k] - 2 * normal_part * e.value[k]) - (square - 2 * normal_part * normal_part)) * n[k] / shear;
      normal += e.vector[k] * (r * n[k] - slope);
    }
    out[i].at = dir * (factor * r);
    out[i].normal = length(normal) > 0 ? normalize(normal) : dir;
    out[i].direction = dir;
  }
}

void GlyphPattern::make_cuboid(const Eigen3& e, double factor, GlyphVertex* out) const {
  const Axes a = axes_of(e, factor, min_ratio_);
  const Vec3 half[3] = {a.x * a.a, a.y * a.b, a.z * a.c}, unit[3] = {a.x, a.y, a.z};
  for (int f = 0; f < 6; ++f) {
    const int k = f / 2;
    const double side = f % 2 ? 1 : -1;
    const Vec3 u = half[(k + 1) % 3] * side, v = half[(k + 2) % 3], middle = half[k] * side;
    const Vec3 corners[4] = {middle - u - v, middle + u - v, middle + u + v, middle - u + v};
    for (int c = 0; c < 4; ++c) out[4 * f + c] = {corners[c], unit[k] * side, unit[k]};
  }
}

void GlyphPattern::make_cylinder(const Eigen3& e, double factor, GlyphVertex* out) const {
  const Axes a = axes_of(e, factor, min_ratio_);
  const int m = 2 * rows_;
  for (int end = 0; end < 2; ++end)
    for (int s = 0; s < m; ++s) {
      const double t = 2 * M_PI * s / m, c = std::cos(t), d = std::sin(t), up = end ? 1 : -1;
      const Vec3 at = combine(a, a.a * c, a.b * d, a.c * up);
      out[end * m + s] = {at, normalize(combine(a, c / a.a, d / a.b, 0)), combine(a, c, d, 0)};
      out[(2 + end) * m + s] = {at, a.z * up, a.z};
    }
}

}  // namespace sg
