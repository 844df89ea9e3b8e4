// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/sym_tensor.h"

#include <algorithm>

namespace sg {

namespace {

// The largest component positive: one of the two signs, the same on every machine.
Vec3 with_fixed_sign(Vec3 v) {
  int at = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(v[k]) > std::abs(v[at])) at = k;
  return v[at] < 0 ? -v : v;
}

Eigen3 no_eigen() {
  Eigen3 e;
  for (int k = 0; k < 3; ++k) e.value[k] = NAN, e.vector[k] = {NAN, NAN, NAN};
  return e;
}

// One rotation in the plane (p, q) that makes a[p][q] zero (Rutishauser's form: small angles, no cancellation).
void rotate(double a[3][3], double v[3][3], int p, int q) {
  if (a[p][q] == 0) return;
  const double h = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const double t = std::abs(h) > 1e150 ? 0.5 / h : (h < 0 ? -1.0 : 1.0) / (std::abs(h) + std::sqrt(1 + h * h));
  const double c = 1 / std::sqrt(1 + t * t), s = t * c, tau = s / (1 + c), shift = t * a[p][q];
  a[p][p] -= shift, a[q][q] += shift;
  a[p][q] = a[q][p] = 0;
  const int r = 3 - p - q;
  const double rp = a[r][p], rq = a[r][q];
  a[r][p] = a[p][r] = rp - s * (rq + tau * rp);
  a[r][q] = a[q][r] = rq + s * (rp - tau * rq);
  for (int i = 0; i < 3; ++i) {
    const double x = v[i][p], y = v[i][q];
    v[i][p] = x - s * (y + tau * x);
    v[i][q] = y + s * (x - tau * y);
  }
}

}  // namespace

double SymTensor::max_abs() const { return std::max({std::abs(xx), std::abs(yy), std::abs(zz), std::abs(xy), std::abs(yz), std::abs(xz)}); }

double SymTensor::norm() const {
  const double m = max_abs();
  if (!(m > 0) || !std::isfinite(m)) return finite() ? 0 : NAN;
  const SymTensor d = *this * (m < 1e-290 ? 0x1p1000 : 1 / m);
  const double n = std::sqrt(d.xx * d.xx + d.yy * d.yy + d.zz * d.zz + 2 * (d.xy * d.xy + d.yz * d.yz + d.xz * d.xz));
  return m < 1e-290 ? n * 0x1p-1000 : n * m;
}

SymTensor SymTensor::deviator() const {
  const double mean = trace() / 3;
  return {xx - mean, yy - mean, zz - mean, xy, yz, xz};
}

SymTensor outer(Vec3 v, double s) { return {s * v.x * v.x, s * v.y * v.y, s * v.z * v.z, s * v.x * v.y, s * v.y * v.z, s * v.x * v.z}; }

SymTensor rotated(const SymTensor& d, const Mat3& r) {
  const Vec3 row[3] = {{r.m[0][0], r.m[0][1], r.m[0][2]}, {r.m[1][0], r.m[1][1], r.m[1][2]}, {r.m[2][0], r.m[2][1], r.m[2][2]}};
  const Vec3 dx = d * row[0], dy = d * row[1], dz = d * row[2];
  return {dot(row[0], dx), dot(row[1], dy), dot(row[2], dz), dot(row[0], dy), dot(row[1], dz), dot(row[0], dz)};
}

Eigen3 eigen_of(const SymTensor& d) {
  if (!d.finite()) return no_eigen();
  const double size = d.max_abs();
  if (!(size > 0)) return {};
  int exponent = 0;
  std::frexp(size, &exponent);  // scaling by a power of two is exact
  auto scaled = [&](double x) { return std::ldexp(x, -exponent); };
  double a[3][3] = {
      {scaled(d.xx), scaled(d.xy), scaled(d.xz)}, {scaled(d.xy), scaled(d.yy), scaled(d.yz)}, {scaled(d.xz), scaled(d.yz), scaled(d.zz)}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  // Off-diagonals fall quadratically: 3 or 4 sweeps; what is left below 1e-18 of the largest entry changes nothing.
  for (int sweep = 0; sweep < 12; ++sweep) {
    if (std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]) < 1e-18) break;
    rotate(a, v, 0, 1);
    rotate(a, v, 0, 2);
    rotate(a, v, 1, 2);
  }
  int order[3] = {0, 1, 2};
  if (a[order[0]][order[0]] < a[order[1]][order[1]]) std::swap(order[0], order[1]);
  if (a[order[1]][order[1]] < a[order[2]][order[2]]) std::swap(order[1], order[2]);
  if (a[order[0]][order[0]] < a[order[1]][order[1]]) std::swap(order[0], order[1]);
  Eigen3 e;
  for (int k = 0; k < 3; ++k) {
    const int c = order[k];
    e.value[k] = std::ldexp(a[c][c], exponent);
    e.vector[k] = {v[0][c], v[1][c], v[2][c]};
  }
  e.vector[0] = with_fixed_sign(normalize(e.vector[0]));
  e.vector[1] = with_fixed_sign(normalize(e.vector[1] - e.vector[0] * dot(e.vector[0], e.vector[1])));
  e.vector[2] = cross(e.vector[0], e.vector[1]);
  return e;
}

Eigen3 eigen_in_plane(const SymTensor& d) {
  if (!(0 * d.xx + 0 * d.yy + 0 * d.xy == 0)) return no_eigen();
  const double size = std::max({std::abs(d.xx), std::abs(d.yy), std::abs(d.xy)});
  Eigen3 e;
  if (!(size > 0)) return e;
  const double h = (d.xx / size - d.yy / size) / 2, g = d.xy / size, r = std::hypot(h, g), mean = (d.xx / size + d.yy / size) / 2;
  e.value[0] = (mean + r) * size, e.value[1] = (mean - r) * size;
  if (g == 0) e.value[0] = std::max(d.xx, d.yy), e.value[1] = std::min(d.xx, d.yy);
  const double angle = r > 0 ? std::atan2(g, h) / 2 : 0;
  e.vector[0] = with_fixed_sign(g == 0 ? (h >= 0 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)) : Vec3(std::cos(angle), std::sin(angle), 0));
  e.vector[1] = with_fixed_sign({-e.vector[0].y, e.vector[0].x, 0});
  e.vector[2] = cross(e.vector[0], e.vector[1]);
  return e;
}

SymTensor compose(const Eigen3& e) {
  return outer(e.vector[0], e.value[0]) + outer(e.vector[1], e.value[1]) + outer(e.vector[2], e.value[2]);
}

SymTensor log_of(const SymTensor& d, double floor) {
  Eigen3 e = eigen_of(d);
  for (double& v : e.value) v = std::log(v < floor ? floor : v);
  return compose(e);
}

SymTensor exp_of(const SymTensor& d) {
  Eigen3 e = eigen_of(d);
  for (double& v : e.value) v = std::exp(v);
  return compose(e);
}

}  // namespace sg
