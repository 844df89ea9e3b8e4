// SPDX-License-Identifier: Apache-2.0
// What a line on a surface follows in a triangle: the vectors, or the eigenvectors of the tensors, at its corners.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "filter/tensor/sym_tensor.h"

namespace sg {

/// A triangle with the edges e1, e2 from its first corner: two numbers for each corner, of which the directions are made, and the products
/// of the edges.
struct SurfaceFrame {
  double u[3], w[3];
  double a, b, c;  // e1.e1, e1.e2, e2.e2
  double least2;   // square of what counts as nothing
};

/// A direction along a triangle, u e1 + w e2, and the square of its length.
struct SurfaceDirection {
  double u, w, length2;
};

/// The parts of vectors along the triangle, linear between the corners.
struct VectorDirections {
  using Value = Vec3;
  using Frame = SurfaceFrame;
  static constexpr bool has_sign = true;

  static void set(Frame& f, const std::array<Vec3, 3>& corners, Vec3 e1, Vec3 e2) {
    const double inverse = 1 / (f.a * f.c - f.b * f.b);
    f.least2 = 0;
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 v = corners[k];
      const double x = dot(v, e1), y = dot(v, e2);
      f.u[k] = (f.c * x - f.b * y) * inverse, f.w[k] = (f.a * y - f.b * x) * inverse;
      f.least2 = std::max(f.least2, 1e-18 * dot(v, v));
    }
  }
  /// False where there is none.
  static bool at(const Frame& f, const std::array<double, 3>& b, SurfaceDirection& d) {
    d.u = f.u[0] * b[0] + f.u[1] * b[1] + f.u[2] * b[2], d.w = f.w[0] * b[0] + f.w[1] * b[1] + f.w[2] * b[2];
    d.length2 = d.u * d.u * f.a + 2 * d.u * d.w * f.b + d.w * d.w * f.c;
    return d.length2 > f.least2 && d.length2 < HUGE_VAL;
  }
};

/// A symmetric tensor in the plane of two edges, by unit vectors along the first and across it: [mean + f, g; g, mean - f].
/// f + ig is r (cos 2t + i sin 2t), where t is the angle of the eigenvector of the larger eigenvalue, mean + r.
struct PlaneTensor {
  double mean, f, g;
  PlaneTensor(const SymTensor& d, Vec3 e1, Vec3 e2) {
    const Vec3 x = e1 / length(e1), across = e2 - x * dot(e2, x), y = across / length(across);
    const double xx = d.along(x), yy = d.along(y);
    mean = 0.5 * (xx + yy), f = 0.5 * (xx - yy), g = dot(x, d * y);
  }
  /// Difference of the eigenvalues over the sum of their absolute values: 0 where they are equal, 1 where one is zero or the signs differ.
  double anisotropy() const {
    const double r = std::hypot(f, g), sum = std::abs(mean + r) + std::abs(mean - r);
    return r > 0 ? 2 * r / sum : sum >= 0 ? 0 : NAN;
  }
};

/// Eigenvectors of the larger eigenvalue of tensors in the triangle's plane; the tensors (not the eigenvectors) are linear between the
/// corners. For those of the smaller one: the negative tensors. Either sign: the walker keeps that of the line.
struct AxisDirections {
  using Value = SymTensor;
  struct Frame : SurfaceFrame {
    double per_x, per_y, shear;  // unit vectors along e1 and across it: per_x e1, per_y e2 - shear e1
  };
  static constexpr bool has_sign = false;

  static void set(Frame& f, const std::array<SymTensor, 3>& corners, Vec3 e1, Vec3 e2) {
    double size = 0;  // the common factor of the corners does not matter; without it nothing over- or underflows
    for (const SymTensor& d : corners) size = std::max(size, d.max_abs());
    f.least2 = 0;
    for (size_t k = 0; k < 3; ++k) {
      const SymTensor& d = corners[k];
      const auto part = [&](double x) { return size > 0 ? x / size : x; };
      const PlaneTensor p({part(d.xx), part(d.yy), part(d.zz), part(d.xy), part(d.yz), part(d.xz)}, e1, e2);
      f.u[k] = p.f, f.w[k] = p.g;
      f.least2 = std::max(f.least2, 1e-12 * (p.mean * p.mean + p.f * p.f + p.g * p.g));  // eigenvalues equal to a millionth
    }
    const double height = std::sqrt(f.c - f.b * f.b / f.a);
    f.per_x = 1 / std::sqrt(f.a), f.per_y = 1 / height, f.shear = f.b / f.a / height;
  }
  static bool at(const Frame& f, const std::array<double, 3>& b, SurfaceDirection& d) {
    const double x = f.u[0] * b[0] + f.u[1] * b[1] + f.u[2] * b[2], y = f.w[0] * b[0] + f.w[1] * b[1] + f.w[2] * b[2];
    const double r2 = x * x + y * y;
    if (!(r2 > f.least2) || !(r2 < HUGE_VAL)) return false;
    const double r = std::sqrt(r2);  // half the angle, from the sum that does not cancel
    const double p = x >= 0 ? r + x : std::abs(y), q = x >= 0 ? y : std::copysign(r - x, y);
    d = {p * f.per_x - q * f.shear, q * f.per_y, 2 * r * (r + std::abs(x))};
    return true;
  }
};

}  // namespace sg
