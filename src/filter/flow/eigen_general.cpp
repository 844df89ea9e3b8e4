// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/eigen_general.h"

#include <algorithm>

namespace sg {

namespace {

double norm(const Mat3& a) {
  double most = 0;
  for (const auto& row : a.m)
    for (const double e : row) most = std::isnan(e) ? e : std::max(most, std::abs(e));
  return most;
}

}  // namespace

GeneralEigenvalues general_eigenvalues(const Mat3& given) {
  GeneralEigenvalues out;
  double scale = 0;
  for (const auto& row : given.m)
    for (const double e : row) {
      if (!std::isfinite(e)) {
        out.real[0] = out.real[1] = out.real[2] = NAN;
        return out;
      }
      scale = std::max(scale, std::abs(e));
    }
  if (scale == 0) return out;
  Mat3 a = given;
  for (auto& row : a.m)
    for (double& e : row) e /= scale;
  // Without its trace the matrix has x^3 + p x + q = 0.
  const double mean = (a.m[0][0] + a.m[1][1] + a.m[2][2]) / 3;
  for (int i = 0; i < 3; ++i) a.m[i][i] -= mean;
  const auto minor = [&](int i, int j) { return a.m[i][i] * a.m[j][j] - a.m[i][j] * a.m[j][i]; };
  const double p = minor(0, 1) + minor(0, 2) + minor(1, 2), q = -determinant(a);
  const double third = p / 3, half = q / 2;
  const double discriminant = half * half + third * third * third;
  const double doubt = 1e-15;  // rounding of the two terms, which are of order 1
  const auto polish = [&](double x) {
    for (int k = 0; k < 2; ++k) {
      const double slope = 3 * x * x + p;
      if (std::abs(slope) > 1e-8) x -= ((x * x + p) * x + q) / slope;
    }
    return x;
  };
  if (discriminant > doubt * (half * half + std::abs(third * third * third))) {
    const double root = std::sqrt(discriminant);
    const double u = std::cbrt(half > 0 ? -half - root : -half + root);
    const double x = polish(u == 0 ? 0 : u - third / u);
    out.complex_pair = true;
    out.real[0] = scale * (mean + x);
    out.re = scale * (mean - x / 2);
    out.im = scale * std::sqrt(std::max(0.0, p + 0.75 * x * x));  // the pair's product is x^2 + p
    if (out.im > 0) return out;
    out.complex_pair = false;
    out.real[1] = out.real[2] = out.re;
    std::sort(out.real, out.real + 3, [](double l, double r) { return l > r; });
    return out;
  }
  const double m = std::sqrt(std::max(0.0, -third));
  const double angle = m > 0 ? std::acos(std::clamp(-half / (m * m * m), -1.0, 1.0)) / 3 : 0;
  for (int k = 0; k < 3; ++k) out.real[k] = scale * (mean + polish(2 * m * std::cos(angle - 2 * 3.14159265358979323846 * k / 3)));
  std::sort(out.real, out.real + 3, [](double l, double r) { return l > r; });
  return out;
}

Vec3 eigenvector_of(const Mat3& a, double lambda) {
  Vec3 row[3];
  for (int i = 0; i < 3; ++i) {
    row[i] = {a.m[i][0], a.m[i][1], a.m[i][2]};
    row[i][i] -= lambda;
  }
  Vec3 best;
  double most = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 c = cross(row[i], row[(i + 1) % 3]);
    if (dot(c, c) > most) most = dot(c, c), best = c;
  }
  const double size = norm(a) + std::abs(lambda);
  if (most > 1e-24 * size * size * size * size) return normalize(best);
  // A plane of eigenvectors: any across the largest row.
  Vec3 across;
  for (const Vec3& r : row)
    if (dot(r, r) > dot(across, across)) across = r;
  if (dot(across, across) <= 1e-24 * size * size) return {1, 0, 0};
  const Vec3 axis = std::abs(across.x) < std::abs(across.y) ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  return normalize(cross(across, axis));
}

}  // namespace sg
