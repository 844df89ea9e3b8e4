// SPDX-License-Identifier: Apache-2.0
// Velocities in linear hexahedra, of curvilinear grids and of meshes: the trilinear map of the last cell is inverted from the last place,
// and where that ends outside, the cell across that face is next. Internal to filter/flow.
#pragma once
#include "filter/flow/flow_access.h"

namespace sg {

class HexCursor {
 public:
  HexCursor(const FlowAccess& access, PointVectors vectors) : access_(&access), v_(vectors) {}

  /// False when the walk is lost: at a border, in a collapsed cell, or at the start. A tree has to tell; then set().
  bool find(Vec3 x) {
    if (cell_ < 0) return false;
    for (int n = 0; n < 64; ++n) {
      if (!invert(x)) return false;
      int axis = -1;
      double worst = 1e-9;
      for (int a = 0; a < 3; ++a) {
        const double out = std::max(-r_[a], r_[a] - 1);
        if (out > worst) worst = out, axis = a;
      }
      if (axis < 0) return true;
      const bool up = r_[axis] > 0.5;
      const int64_t next = across(axis, up);
      if (next < 0) return false;
      open(next);
      // In a grid the axes go on; elsewhere they may be any.
      if (access_->curvilinear) r_[axis] += up ? -1 : 1;
      else r_ = {0.5, 0.5, 0.5};
      for (int a = 0; a < 3; ++a) r_[a] = std::clamp(r_[a], 0.0, 1.0);
    }
    return false;
  }
  /// In a cell that somebody else found; false where its map does not lead to x.
  bool set(int64_t cell, Vec3 x) {
    if (cell != cell_) open(cell);
    r_ = {0.5, 0.5, 0.5};
    if (!invert(x)) return false;
    for (int a = 0; a < 3; ++a)
      if (!(r_[a] >= -1e-6 && r_[a] <= 1 + 1e-6)) return false;
    return true;
  }
  Vec3 velocity() const { return at(u_, r_); }
  Mat3 gradient() const {
    Vec3 dx[3], du[3];
    slopes(x_, r_, dx), slopes(u_, r_, du);
    Mat3 m;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) m.m[a][b] = dx[b][a];
    const double det = determinant(m);
    Mat3 j;
    for (auto& row : j.m)
      for (double& e : row) e = NAN;
    if (!(std::abs(det) > 0)) return j;
    const Mat3 inv = inverse(m);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) j.m[a][b] = du[0][a] * inv.m[0][b] + du[1][a] * inv.m[1][b] + du[2][a] * inv.m[2][b];
    return j;
  }
  int64_t cell() const { return cell_; }
  double length() const { return std::cbrt(box_.x * box_.y * box_.z); }
  int corners(int64_t ids[8], double weights[8]) const {
    for (int k = 0; k < 8; ++k) {
      ids[k] = id_[k], weights[k] = 1;
      for (int a = 0; a < 3; ++a) weights[k] *= corner[k][a] ? r_[a] : 1 - r_[a];
    }
    return 8;
  }

 private:
  // Corners in the order of a hexahedron.
  static constexpr int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  using Map = Vec3[8];  // coefficients of 1, r, s, t, rs, st, tr, rst

  static Vec3 at(const Map& c, Vec3 r) {
    return c[0] + c[1] * r.x + c[2] * r.y + c[3] * r.z + c[4] * (r.x * r.y) + c[5] * (r.y * r.z) + c[6] * (r.z * r.x) +
           c[7] * (r.x * r.y * r.z);
  }
  static void slopes(const Map& c, Vec3 r, Vec3 d[3]) {
    d[0] = c[1] + c[4] * r.y + c[6] * r.z + c[7] * (r.y * r.z);
    d[1] = c[2] + c[4] * r.x + c[5] * r.z + c[7] * (r.z * r.x);
    d[2] = c[3] + c[5] * r.y + c[6] * r.x + c[7] * (r.x * r.y);
  }
  static void coefficients(const Vec3 p[8], Map& c) {
    c[0] = p[0], c[1] = p[1] - p[0], c[2] = p[3] - p[0], c[3] = p[4] - p[0];
    c[4] = p[2] - p[1] - p[3] + p[0], c[5] = p[7] - p[3] - p[4] + p[0], c[6] = p[5] - p[1] - p[4] + p[0];
    c[7] = p[6] - p[2] - p[5] - p[7] + p[1] + p[3] + p[4] - p[0];
  }
  // Newton from the last place. False where it does not converge near the cell.
  bool invert(Vec3 x) {
    for (int n = 0; n < 20; ++n) {
      Vec3 d[3];
      slopes(x_, r_, d);
      const Vec3 miss = x - at(x_, r_), c12 = cross(d[1], d[2]);
      const double det = dot(d[0], c12);
      if (!(std::abs(det) > 0)) return false;
      const Vec3 step = Vec3(dot(miss, c12), dot(d[0], cross(miss, d[2])), dot(d[0], cross(d[1], miss))) / det;
      r_ += step;
      const double size = std::max({std::abs(step.x), std::abs(step.y), std::abs(step.z)});
      if (size < 1e-11) return true;
      const double far = std::max({std::abs(r_.x), std::abs(r_.y), std::abs(r_.z)});
      // Far outside the map says nothing of where x is, but the way there is right.
      if (!(far < 8)) return false;
      if (far > 3 && n > 2) return true;
    }
    return false;
  }
  int64_t across(int axis, bool up) const {
    if (!access_->curvilinear) return access_->hex_neighbors->across[6 * size_t(cell_) + size_t(2 * axis + up)];
    const auto cells = access_->curvilinear->view().cell_dims();
    const size_t stride = axis == 0 ? 1 : axis == 1 ? cells[0] : cells[0] * cells[1];
    const size_t i = size_t(cell_) / stride % cells[size_t(axis)];
    if (up ? i + 1 == cells[size_t(axis)] : i == 0) return -1;
    return up ? cell_ + int64_t(stride) : cell_ - int64_t(stride);
  }
  void open(int64_t cell) {
    cell_ = cell;
    Vec3 p[8], u[8];
    if (access_->curvilinear) {
      const LatticeView& v = access_->curvilinear->view();
      const auto cells = v.cell_dims();
      const size_t i = size_t(cell) % cells[0], j = size_t(cell) / cells[0] % cells[1], k = size_t(cell) / cells[0] / cells[1];
      for (int n = 0; n < 8; ++n) {
        const size_t a = i + size_t(corner[n][0]), b = j + size_t(corner[n][1]), c = k + size_t(corner[n][2]);
        id_[n] = int64_t(v.id(a, b, c)), p[n] = v.position(a, b, c);
      }
    } else {
      for (int n = 0; n < 8; ++n) p[n] = access_->simplices.point(id_[n] = access_->simplices.id(size_t(cell), n));
    }
    Vec3 lo = p[0], hi = p[0];
    for (int n = 0; n < 8; ++n) {
      u[n] = v_(size_t(id_[n]));
      for (int a = 0; a < 3; ++a) lo[a] = std::min(lo[a], p[n][a]), hi[a] = std::max(hi[a], p[n][a]);
    }
    box_ = hi - lo;
    coefficients(p, x_), coefficients(u, u_);
  }
  const FlowAccess* access_;
  PointVectors v_;
  int64_t cell_ = -1, id_[8];
  Map x_, u_;
  Vec3 r_, box_;
};

}  // namespace sg
