// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/cells/leaf_lattice.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sg::volume {

bool LeafLattice::open(std::span<const Vec3> at, std::span<const double> values, const std::function<size_t()>& face_count,
                       const std::function<std::span<const uint32_t>(size_t)>& face) {
  Box3 box;
  for (Vec3 p : at) box.add(p);
  const Vec3 size = box.size();
  if (!(size.x > 0 && size.y > 0 && size.z > 0)) return false;
  // As many little boxes as the closest nodes ask for.
  for (n_ = 1; n_ <= most; ++n_) {
    bool fits = true;
    for (Vec3 p : at)
      for (int a = 0; a < 3; ++a) {
        const double u = (p[a] - box.lo[a]) / size[a] * n_;
        fits = fits && std::abs(u - std::round(u)) < 1e-4;
      }
    if (fits) break;
  }
  if (n_ > most) return false;
  lo_ = box.lo;
  for (int a = 0; a < 3; ++a) per_[a] = n_ / size[a];
  const size_t m = size_t(n_) + 1;
  f_.assign(m * m * m, NAN);
  const auto place = [&](size_t i, int p[3]) {
    for (int a = 0; a < 3; ++a) p[a] = int(std::lround((at[i][a] - lo_[a]) * per_[a]));
  };
  for (size_t i = 0; i < at.size(); ++i) {
    int p[3];
    place(i, p);
    node(p) = values[i];
  }
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 4; ++side) {
      int p[3] = {};
      p[(axis + 1) % 3] = side & 1 ? n_ : 0, p[(axis + 2) % 3] = side & 2 ? n_ : 0;
      fill_line(p, axis, n_);
    }
  for (size_t k = 0, count = face_count(); k < count; ++k) {
    int lo[3] = {n_, n_, n_}, hi[3] = {};
    for (uint32_t i : face(k)) {
      int p[3];
      place(i, p);
      for (int a = 0; a < 3; ++a) lo[a] = std::min(lo[a], p[a]), hi[a] = std::max(hi[a], p[a]);
    }
    fill_face(lo, hi);
  }
  fill_inside();
  return std::none_of(f_.begin(), f_.end(), [](double f) { return std::isnan(f); });
}

/// Straight between the nodes that are known.
void LeafLattice::fill_line(const int from[3], int axis, int count) {
  int p[3] = {from[0], from[1], from[2]}, q[3] = {from[0], from[1], from[2]};
  int known = 0;
  for (int i = 1; i <= count; ++i) {
    p[axis] = from[axis] + i;
    if (std::isnan(node(p))) continue;
    q[axis] = from[axis] + known;
    const double a = node(q), b = node(p);
    for (int k = known + 1; k < i; ++k) {
      q[axis] = from[axis] + k;
      node(q) = a + (b - a) * (k - known) / (i - known);
    }
    known = i;
  }
}

void LeafLattice::fill_face(const int lo[3], const int hi[3]) {
  int across = 0;
  while (across < 2 && lo[across] != hi[across]) ++across;
  const int u = (across + 1) % 3, v = (across + 2) % 3, nu = hi[u] - lo[u], nv = hi[v] - lo[v];
  const auto at = [&](int i, int j) -> double& {
    int p[3];
    p[across] = lo[across], p[u] = lo[u] + i, p[v] = lo[v] + j;
    return node(p);
  };
  for (int side = 0; side < 2; ++side) {
    int p[3] = {lo[0], lo[1], lo[2]}, q[3] = {lo[0], lo[1], lo[2]};
    if (side) p[v] = hi[v], q[u] = hi[u];
    fill_line(p, u, nu), fill_line(q, v, nv);
  }
  for (int j = 1; j < nv; ++j)
    for (int i = 1; i < nu; ++i) {
      if (!std::isnan(at(i, j))) continue;
      const double s = double(i) / nu, t = double(j) / nv;
      at(i, j) = (1 - s) * at(0, j) + s * at(nu, j) + (1 - t) * at(i, 0) + t * at(i, nv) -
                 ((1 - s) * (1 - t) * at(0, 0) + s * (1 - t) * at(nu, 0) + (1 - s) * t * at(0, nv) + s * t * at(nu, nv));
    }
}

void LeafLattice::fill_inside() {
  const int n = n_;
  for (int k = 1; k < n; ++k)
    for (int j = 1; j < n; ++j)
      for (int i = 1; i < n; ++i) {
        const double r[3] = {double(i) / n, double(j) / n, double(k) / n};
        const int p[3] = {i, j, k};
        // Faces less edges plus corners, each by its own share.
        double sum = 0;
        for (int which = 1; which < 27; ++which) {
          const int side[3] = {which % 3, which / 3 % 3, which / 9};  // per axis: 0 = stays, 1 = low end, 2 = high end
          int q[3], ends = 0;
          double w = 1;
          for (int a = 0; a < 3; ++a) {
            q[a] = side[a] == 0 ? p[a] : side[a] == 1 ? 0 : n;
            if (side[a]) ++ends, w *= side[a] == 1 ? 1 - r[a] : r[a];
          }
          sum += (ends == 2 ? -w : w) * node(q);
        }
        node(p) = sum;
      }
}

double LeafLattice::value(Vec3 x) const {
  int cell[3];
  double f[3];
  for (int a = 0; a < 3; ++a) {
    const double u = (x[a] - lo_[a]) * per_[a];
    cell[a] = std::clamp(int(std::floor(u)), 0, n_ - 1);
    f[a] = u - cell[a];
  }
  const size_t m = size_t(n_) + 1, at = size_t(cell[0]) + m * (size_t(cell[1]) + m * size_t(cell[2]));
  const auto row = [&](size_t i) { return f_[i] + f[0] * (f_[i + 1] - f_[i]); };
  const auto plane = [&](size_t i) { return row(i) + f[1] * (row(i + m) - row(i)); };
  return plane(at) + f[2] * (plane(at + m * m) - plane(at));
}

void LeafLattice::cuts(Vec3 x, Vec3 d, double from, double to, std::vector<double>& out) const {
  out.clear();
  for (int a = 0; a < 3; ++a)
    for (int k = 1; k < n_ && d[a] != 0; ++k) {
      const double t = (lo_[a] + k / per_[a] - x[a]) / d[a];
      if (t > from && t < to) out.push_back(t);
    }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

}  // namespace sg::volume
