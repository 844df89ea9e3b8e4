// SPDX-License-Identifier: Apache-2.0
// Velocities in linear tetrahedra by walking across faces from the last one. Internal to filter/flow.
#pragma once
#include "filter/flow/cursors/flow_access.h"

namespace sg {

/// One tetrahedron as affine maps: barycentric coordinates of b, c, d at x are rows * (x - a), the velocity is v + slopes * them.
struct OpenTet {
  Vec3 a, rows[3];
  Vec3 v, slopes[3];
  double tolerance = 0;
  double box = 0;  ///< volume of its box
};

class TetCursor {
 public:
  TetCursor(const FlowAccess& access, PointVectors vectors)
      : s_(&access.simplices), start_(access.start.get()), across_(access.tets->data()), v_(vectors) {}

  enum class Found : uint8_t { here, outside, lost };
  /// Walks to x. Outside: x is outside of the mesh's box. Lost: the walk came to the border, or into a flat cell: a tree search is needed.
  Found find(Vec3 x) {
    if (!start_->may_hold(x)) return Found::outside;
    if (cell_ < 0) open(start_->near(x));
    for (int n = 0; n < 4096; ++n) {
      const Vec3 d = x - t_.a;
      r_ = {dot(t_.rows[0], d), dot(t_.rows[1], d), dot(t_.rows[2], d)};
      const double r[4] = {1 - r_.x - r_.y - r_.z, r_.x, r_.y, r_.z};
      int worst = 0;
      for (int k = 1; k < 4; ++k)
        if (r[k] < r[worst]) worst = k;
      if (r[worst] >= -t_.tolerance) return Found::here;
      if (!(r[worst] < 0)) return Found::lost;  // not a number
      const int32_t next = across_[size_t(cell_) * 4 + size_t(worst)];
      if (next < 0) return Found::lost;
      open(next);
    }
    return Found::lost;
  }
  /// Where x was found elsewhere.
  void set(int64_t cell, Vec3 x) {
    if (cell != cell_) open(int32_t(cell));
    const Vec3 d = x - t_.a;
    r_ = {dot(t_.rows[0], d), dot(t_.rows[1], d), dot(t_.rows[2], d)};
  }
  Vec3 velocity() const { return t_.v + t_.slopes[0] * r_.x + t_.slopes[1] * r_.y + t_.slopes[2] * r_.z; }
  Mat3 gradient() const {
    Mat3 j;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        j.m[a][b] = 0;
        for (int k = 0; k < 3; ++k) j.m[a][b] += t_.slopes[k][a] * t_.rows[k][b];
      }
    return j;
  }
  int64_t cell() const { return cell_; }
  double length() const { return std::cbrt(t_.box); }
  int corners(int64_t ids[8], double weights[8]) const {
    for (int k = 0; k < 4; ++k) ids[k] = s_->id(size_t(cell_), k);
    weights[0] = 1 - r_.x - r_.y - r_.z, weights[1] = r_.x, weights[2] = r_.y, weights[3] = r_.z;
    return 4;
  }

 private:
  void open(int32_t cell) {
    cell_ = cell;
    int64_t id[4];
    Vec3 p[4];
    for (int k = 0; k < 4; ++k) p[k] = s_->point(id[k] = s_->id(size_t(cell), k));
    const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
    const Vec3 vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
    const double scale = 1 / dot(u, vw);
    t_.a = p[0];
    t_.rows[0] = vw * scale, t_.rows[1] = wu * scale, t_.rows[2] = uv * scale;
    t_.v = v_(size_t(id[0]));
    for (int k = 0; k < 3; ++k) t_.slopes[k] = v_(size_t(id[k + 1])) - t_.v;
    t_.tolerance = tetra_tolerance(s_->ease, u);
    Vec3 lo = p[0], hi = p[0];
    for (int k = 1; k < 4; ++k)
      for (int a = 0; a < 3; ++a) lo[a] = std::min(lo[a], p[k][a]), hi[a] = std::max(hi[a], p[k][a]);
    t_.box = (hi.x - lo.x) * (hi.y - lo.y) * (hi.z - lo.z);
  }
  const SimplexArrays* s_;
  const WalkStart* start_;
  const int32_t* across_;
  PointVectors v_;
  int32_t cell_ = -1;
  OpenTet t_;
  Vec3 r_;
};

}  // namespace sg
