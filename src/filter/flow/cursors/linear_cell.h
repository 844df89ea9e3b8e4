// SPDX-License-Identifier: Apache-2.0
// Linear solid cells of all shapes as one map: x = c0 + c1 r + c2 s + c3 t + c4 rs + c5 st + c6 tr + c7 rst, and the same for the velocity.
// Hexahedra and voxels have all terms, wedges no rs, tetrahedra only the first four; a pyramid is a hexahedron whose upper corners are
// one (so its coordinates here are not those of CellShape). Internal to filter/flow.
#pragma once
#include <algorithm>

#include "base/vec.h"
#include "data/cells/cell_type.h"
#include "index/cell_probe.h"

namespace sg {

/// Through which face a place lies outside, as cell_faces() numbers them, and how far in reference units; not outside: face -1.
struct FaceExit {
  int face = -1;
  double outside = 0;
  void add(int f, double out) {
    if (out > outside) outside = out, face = f;
  }
};

/// `base`: tetra, hexahedron, voxel or wedge; r in the coordinates of CellShape.
inline FaceExit exit_of(CellType base, Vec3 r, double tolerance) {
  FaceExit e{-1, tolerance};
  switch (base) {
    case CellType::tetra: e.add(0, -r.y), e.add(1, r.x + r.y + r.z - 1), e.add(2, -r.x), e.add(3, -r.z); break;
    case CellType::wedge: e.add(0, -r.z), e.add(1, r.z - 1), e.add(2, -r.y), e.add(3, r.x + r.y - 1), e.add(4, -r.x); break;
    case CellType::pyramid: {
      const double half = r.z / 2;
      e.add(0, -r.z), e.add(1, half - r.y), e.add(2, r.x - 1 + half), e.add(3, r.y - 1 + half), e.add(4, half - r.x);
      break;
    }
    default:
      for (int a = 0; a < 3; ++a) e.add(2 * a, -r[a]), e.add(2 * a + 1, r[a] - 1);
  }
  return e;
}

class LinearCell {
 public:
  /// Whether this class has a map for the type.
  static bool knows(CellType t) {
    return t == CellType::hexahedron || t == CellType::tetra || t == CellType::wedge || t == CellType::pyramid || t == CellType::voxel;
  }
  static int corners_of(CellType t) { return t == CellType::tetra ? 4 : t == CellType::pyramid ? 5 : t == CellType::wedge ? 6 : 8; }

  void open(CellType type, const int64_t* ids, const Vec3* p, const Vec3* u) {
    type_ = type, count_ = corners_of(type);
    Vec3 lo = p[0], hi = p[0];
    for (int n = 0; n < count_; ++n) {
      id_[n] = ids[n];
      for (int a = 0; a < 3; ++a) lo[a] = std::min(lo[a], p[n][a]), hi[a] = std::max(hi[a], p[n][a]);
    }
    box_ = hi - lo;
    double far = 0;
    for (int a = 0; a < 3; ++a) far = std::max({far, std::abs(lo[a]), std::abs(hi[a])});
    // As CellMap: near misses only, what rounding far from zero amounts to.
    tolerance_ = locate_tolerance + 4 * std::numeric_limits<double>::epsilon() * far / std::max(sg::length(box_), 1e-300);
    coefficients(p, x_), coefficients(u, u_);
  }
  void start_in_middle() {
    r_ = type_ == CellType::tetra ? Vec3(0.25, 0.25, 0.25) : type_ == CellType::wedge ? Vec3(1.0 / 3, 1.0 / 3, 0.5) : Vec3(0.5, 0.5, 0.5);
  }
  Vec3& at() { return r_; }

  /// Newton from at(). False where it does not converge near the cell. `quick`: also true when it is clear that x lies well outside; at()
  /// then gives only the direction.
  bool invert(Vec3 x, bool quick) {
    for (int n = 0; n < 20; ++n) {
      Vec3 d[3];
      slopes(x_, r_, d);
      const Vec3 miss = x - value(x_, r_), c12 = cross(d[1], d[2]);
      const double det = dot(d[0], c12);
      if (!(std::abs(det) > 0)) return false;
      const Vec3 step = Vec3(dot(miss, c12), dot(d[0], cross(miss, d[2])), dot(d[0], cross(d[1], miss))) / det;
      r_ += step;
      const double size = std::max({std::abs(step.x), std::abs(step.y), std::abs(step.z)});
      if (size < 1e-8) return true;  // the error that is left is about its square
      const double far = std::max({std::abs(r_.x - 0.5), std::abs(r_.y - 0.5), std::abs(r_.z - 0.5)});
      if (!(far < 1e6)) return false;
      if (quick && far > 2) return true;
      if (far > 8) return false;
    }
    return false;
  }
  /// Of at().
  FaceExit exit() const {
    if (type_ != CellType::pyramid) return exit_of(type_, r_, tolerance_);
    FaceExit e{-1, tolerance_};
    const double w = std::max(1 - r_.z, 0.0);  // the section at this height
    e.add(0, -r_.z), e.add(1, -r_.y * w), e.add(2, (r_.x - 1) * w), e.add(3, (r_.y - 1) * w), e.add(4, -r_.x * w);
    if (r_.z - 1 > tolerance_) e = {-2, r_.z - 1};  // beyond the tip
    return e;
  }

  Vec3 velocity() const { return value(u_, r_); }
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
  int count() const { return count_; }
  double length() const { return std::cbrt(box_.x * box_.y * box_.z); }
  /// Ids and weights at the place; how many.
  int corners(int64_t ids[8], double weights[8]) const {
    const Vec3 r = r_;
    std::copy(id_, id_ + count_, ids);
    if (type_ == CellType::tetra) {
      weights[0] = 1 - r.x - r.y - r.z, weights[1] = r.x, weights[2] = r.y, weights[3] = r.z;
    } else if (type_ == CellType::wedge) {
      const double l[3] = {1 - r.x - r.y, r.x, r.y};
      for (int k = 0; k < 6; ++k) weights[k] = l[k % 3] * (k < 3 ? 1 - r.z : r.z);
    } else {
      const bool voxel = type_ == CellType::voxel, pyramid = type_ == CellType::pyramid;
      for (int k = 0; k < (pyramid ? 4 : 8); ++k) {
        const int a = voxel ? k & 1 : ring[k][0], b = voxel ? k >> 1 & 1 : ring[k][1], c = k >> 2;
        weights[k] = (a ? r.x : 1 - r.x) * (b ? r.y : 1 - r.y) * (c ? r.z : 1 - r.z);
      }
      if (pyramid) weights[4] = r.z;
    }
    return count_;
  }

 private:
  static constexpr int ring[8][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 1}};
  using Map = Vec3[8];

  static Vec3 value(const Map& c, Vec3 r) {
    return c[0] + c[1] * r.x + c[2] * r.y + c[3] * r.z + c[4] * (r.x * r.y) + c[5] * (r.y * r.z) + c[6] * (r.z * r.x) +
           c[7] * (r.x * r.y * r.z);
  }
  static void slopes(const Map& c, Vec3 r, Vec3 d[3]) {
    d[0] = c[1] + c[4] * r.y + c[6] * r.z + c[7] * (r.y * r.z);
    d[1] = c[2] + c[4] * r.x + c[5] * r.z + c[7] * (r.z * r.x);
    d[2] = c[3] + c[5] * r.y + c[6] * r.x + c[7] * (r.x * r.y);
  }
  void coefficients(const Vec3* p, Map& c) const {
    c[0] = p[0], c[1] = p[1] - p[0];
    switch (type_) {
      case CellType::tetra: c[2] = p[2] - p[0], c[3] = p[3] - p[0], c[4] = c[5] = c[6] = c[7] = Vec3(); break;
      case CellType::wedge:
        c[2] = p[2] - p[0], c[3] = p[3] - p[0];
        c[5] = p[5] - p[3] - p[2] + p[0], c[6] = p[4] - p[3] - p[1] + p[0], c[4] = c[7] = Vec3();
        break;
      case CellType::pyramid:
        c[2] = p[3] - p[0], c[3] = p[4] - p[0];
        c[4] = p[2] - p[1] - p[3] + p[0], c[5] = p[0] - p[3], c[6] = p[0] - p[1], c[7] = -c[4];
        break;
      default: {
        const bool voxel = type_ == CellType::voxel;
        const Vec3 &p2 = p[voxel ? 3 : 2], &p3 = p[voxel ? 2 : 3], &p6 = p[voxel ? 7 : 6], &p7 = p[voxel ? 6 : 7];
        c[2] = p3 - p[0], c[3] = p[4] - p[0];
        c[4] = p2 - p[1] - p3 + p[0], c[5] = p7 - p3 - p[4] + p[0], c[6] = p[5] - p[1] - p[4] + p[0];
        c[7] = p6 - p2 - p[5] - p7 + p[1] + p3 + p[4] - p[0];
      }
    }
  }
  CellType type_ = CellType::hexahedron;
  int count_ = 8;
  int64_t id_[8];
  Map x_, u_;
  Vec3 r_, box_;
  double tolerance_ = 0;
};

}  // namespace sg
