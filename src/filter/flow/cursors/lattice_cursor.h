// SPDX-License-Identifier: Apache-2.0
// Velocities in uniform and rectilinear grids by arithmetic. Internal to filter/flow.
#pragma once
#include <algorithm>

#include "filter/flow/cursors/flow_access.h"

namespace sg {

class LatticeCursor {
 public:
  LatticeCursor(const LatticeFlow& lattice, PointVectors vectors) : l_(&lattice), v_(vectors), length_(lattice.length) {}

  /// False outside (solids: by more than 1e-9 of a cell; flat grids: further than a cell from their plane).
  bool find(Vec3 x) {
    const LatticeFlow& l = *l_;
    if (!l.separable) {
      const Vec3 d = x - l.origin;
      for (int a = 0; a < 3; ++a) {
        const double q = dot(l.rows[a], d);
        if (a == l.flat_axis) {
          if (!(std::abs(q) <= l.length)) return false;
          continue;
        }
        const double n = double(l.cells[size_t(a)]);
        if (!(q >= -1e-9 && q <= n + 1e-9)) return false;
        const double c = std::min(std::max(std::floor(q), 0.0), n - 1);
        p_.i[a] = size_t(c), p_.f[a] = std::min(std::max(q - c, 0.0), 1.0);
      }
      return true;
    }
    double product = 1;
    for (int a = 0; a < 3; ++a) {
      if (a == l.flat_axis) continue;
      if (!find_axis(a, x[a])) return false;
      product *= std::abs(l.axis[a][p_.i[a] + 1] - l.axis[a][p_.i[a]]);
    }
    length_ = l.flat_axis < 0 ? std::cbrt(product) : std::sqrt(product);
    return l.flat_axis < 0 || std::abs(x[l.flat_axis] - l.axis[l.flat_axis][0]) <= length_;
  }
  /// At the place found last.
  Vec3 velocity() const {
    Vec3 v = v_.f32 ? interpolate(v_.f32) : interpolate(v_.f64);
    if (l_->flat_axis >= 0) v = v - l_->normal * dot(l_->normal, v);
    return v;
  }
  Mat3 gradient() const {
    Vec3 slope[3] = {};  // along the axes, per cell
    for (int k = 0; k < 8; ++k) {
      if (l_->flat_axis >= 0 && (k >> l_->flat_axis & 1)) continue;
      const Vec3 v = v_(point(k));
      for (int a = 0; a < 3; ++a) {
        if (a == l_->flat_axis) continue;
        double w = k >> a & 1 ? 1 : -1;
        for (int b = 0; b < 3; ++b)
          if (b != a && b != l_->flat_axis) w *= k >> b & 1 ? p_.f[b] : 1 - p_.f[b];
        slope[a] += v * w;
      }
    }
    Mat3 j;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        j.m[r][c] = 0;
        for (int a = 0; a < 3; ++a)
          if (a != l_->flat_axis) j.m[r][c] += slope[a][r] * inverse(a)[c];
      }
    return j;
  }
  int64_t cell() const { return int64_t(p_.i[0] + l_->cells[0] * (p_.i[1] + l_->cells[1] * p_.i[2])); }
  double length() const { return length_; }
  /// Ids and weights of the corners, bit a of k a step along the a-th axis with cells; how many.
  int corners(int64_t ids[8], double weights[8]) const {
    int n = 0;
    for (int k = 0; k < 8; ++k) {
      if (l_->flat_axis >= 0 && (k >> l_->flat_axis & 1)) continue;
      double w = 1;
      for (int a = 0; a < 3; ++a)
        if (a != l_->flat_axis) w *= k >> a & 1 ? p_.f[a] : 1 - p_.f[a];
      ids[n] = int64_t(point(k)), weights[n++] = w;
    }
    return n;
  }
  /// The nearest place of the plane of a flat grid.
  Vec3 snap(Vec3 x) const {
    if (l_->flat_axis < 0) return x;
    if (!l_->separable) return x - l_->normal * dot(l_->normal, x - l_->origin);
    x[l_->flat_axis] = l_->axis[l_->flat_axis][0];
    return x;
  }

 private:
  size_t point(int k) const {
    size_t id = 0;
    for (int a = 0; a < 3; ++a) id += (p_.i[a] + size_t(k >> a & 1)) * l_->stride[size_t(a)];
    return id;
  }
  // Slope of the a-th coordinate in the cell.
  Vec3 inverse(int a) const {
    if (!l_->separable) return l_->rows[a];
    Vec3 r;
    r[a] = 1 / (l_->axis[a][p_.i[a] + 1] - l_->axis[a][p_.i[a]]);
    return r;
  }
  // From the last cell: most steps stay in it or go to the next.
  bool find_axis(int a, double q) {
    const double* at = l_->axis[a];
    const size_t n = l_->cells[size_t(a)];
    const double sign = at[n] > at[0] ? 1 : -1, slack = 1e-9 * std::abs(at[n] - at[0]) / double(n);
    if (!(sign * (q - at[0]) >= -slack && sign * (at[n] - q) >= -slack)) return false;
    size_t& i = p_.i[a];
    for (int k = 0; k < 3; ++k) {
      if (sign * (q - at[i]) < 0 && i > 0) --i;
      else if (sign * (q - at[i + 1]) > 0 && i + 1 < n) ++i;
      else break;
    }
    const bool here = (sign * (q - at[i]) >= 0 || i == 0) && (sign * (at[i + 1] - q) >= 0 || i + 1 == n);
    if (!here) {
      const double* it = sign > 0 ? std::upper_bound(at, at + n + 1, q) : std::upper_bound(at, at + n + 1, q, std::greater<double>());
      i = size_t(std::clamp<ptrdiff_t>(it - at - 1, 0, ptrdiff_t(n) - 1));
    }
    p_.f[a] = std::min(std::max((q - at[i]) / (at[i + 1] - at[i]), 0.0), 1.0);
    return true;
  }
  template <class T>
  Vec3 interpolate(const T* v) const {
    return v_.components == 3 ? interpolate<T, 3>(v) : interpolate<T, 2>(v);
  }
  template <class T, int N>
  Vec3 interpolate(const T* v) const {
    const auto& s = l_->stride;
    const T* base = v + size_t(N) * (p_.i[0] * s[0] + p_.i[1] * s[1] + p_.i[2] * s[2]);
    const size_t dx = s[0] * N, dy = s[1] * N, dz = s[2] * N;
    Vec3 out;
    for (int c = 0; c < N; ++c) {
      const auto row = [&](size_t at) {
        const double a = double(base[at + size_t(c)]);
        return a + p_.f[0] * (double(base[at + dx + size_t(c)]) - a);
      };
      const double a = row(0), b = row(dy), d = row(dz), e = row(dy + dz);
      const double low = a + p_.f[1] * (b - a), high = d + p_.f[1] * (e - d);
      out[c] = low + p_.f[2] * (high - low);
    }
    return out;
  }
  const LatticeFlow* l_;
  PointVectors v_;
  LatticePlace p_;
  double length_ = 1;
};

}  // namespace sg
