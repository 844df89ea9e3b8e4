// SPDX-License-Identifier: Apache-2.0
// Cuts a tetrahedron along the planes of a grid. The pieces are tetrahedra, each within one grid cell, that fill the original exactly.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "base/vec.h"

namespace sg {

struct ClipVertex {
  Vec3 x;       ///< in units of grid cells
  double b[4];  ///< barycentric coordinates in the tetrahedron that was cut
};

/// Calls emit(volume, mean, i, j, k) for each part within grid cells [lo, hi) per axis: volume in grid cells, mean[4] the barycentric
/// coordinates of its centroid. Parts of one grid cell may be disconnected.
template <class Emit>
class TetClipper {
 public:
  TetClipper(const std::array<ptrdiff_t, 3>& lo, const std::array<ptrdiff_t, 3>& hi, Emit& emit) : lo_(lo), hi_(hi), emit_(emit) {}
  void clip(const Vec3 p[4]) {
    ClipVertex v[4];
    for (int m = 0; m < 4; ++m) {
      v[m] = {p[m], {0, 0, 0, 0}};
      v[m].b[m] = 1;
    }
    along(2, v);
  }

 private:
  void along(int axis, const ClipVertex v[4]) {
    double a = v[0].x[axis], b = a;
    for (int m = 1; m < 4; ++m) a = std::min(a, v[m].x[axis]), b = std::max(b, v[m].x[axis]);
    const double lo = double(lo_[size_t(axis)]), hi = double(hi_[size_t(axis)]);
    if (!(b > lo && a < hi)) return;
    const double first = std::floor(a), last = std::max(std::ceil(b) - 1, first);
    if (first < lo) return split(axis, lo, v);
    if (last >= hi) return split(axis, hi, v);
    if (last > first) return split(axis, std::floor((first + last + 1) / 2), v);
    at_[axis] = ptrdiff_t(first);
    if (axis > 0) along(axis - 1, v);
    else finish(v);
  }
  void finish(const ClipVertex v[4]) {
    const double volume = std::abs(dot(v[1].x - v[0].x, cross(v[2].x - v[0].x, v[3].x - v[0].x))) / 6;
    if (!(volume > 0)) return;
    double mean[4];
    for (int m = 0; m < 4; ++m) mean[m] = (v[0].b[m] + v[1].b[m] + v[2].b[m] + v[3].b[m]) / 4;
    emit_(volume, mean, at_[0], at_[1], at_[2]);
  }
  static ClipVertex cut(int axis, double plane, const ClipVertex& p, const ClipVertex& q) {
    const double t = (plane - p.x[axis]) / (q.x[axis] - p.x[axis]);
    ClipVertex r;
    r.x = p.x + (q.x - p.x) * t;
    r.x[axis] = plane;
    for (int m = 0; m < 4; ++m) r.b[m] = p.b[m] + (q.b[m] - p.b[m]) * t;
    return r;
  }
  void tetra(int axis, const ClipVertex& a, const ClipVertex& b, const ClipVertex& c, const ClipVertex& d) {
    const ClipVertex v[4] = {a, b, c, d};
    along(axis, v);
  }
  // Between the triangles a and b.
  void wedge(int axis, const ClipVertex a[3], const ClipVertex b[3]) {
    tetra(axis, a[0], a[1], a[2], b[0]);
    tetra(axis, a[1], a[2], b[0], b[1]);
    tetra(axis, a[2], b[0], b[1], b[2]);
  }
  void split(int axis, double plane, const ClipVertex v[4]) {
    const ClipVertex *below[4], *above[4];
    int n = 0, p = 0;
    for (int m = 0; m < 4; ++m)
      if (v[m].x[axis] < plane) below[n++] = &v[m];
      else above[p++] = &v[m];
    auto side = [&](const ClipVertex* const* apex, const ClipVertex* const* others) {  // one corner against three
      ClipVertex c[3], o[3];
      for (int m = 0; m < 3; ++m) c[m] = cut(axis, plane, *apex[0], *others[m]), o[m] = *others[m];
      tetra(axis, *apex[0], c[0], c[1], c[2]);
      wedge(axis, c, o);
    };
    if (n == 1) return side(below, above);
    if (n == 3) return side(above, below);
    const ClipVertex ac = cut(axis, plane, *below[0], *above[0]), ad = cut(axis, plane, *below[0], *above[1]),
                     bc = cut(axis, plane, *below[1], *above[0]), bd = cut(axis, plane, *below[1], *above[1]);
    const ClipVertex low_a[3] = {*below[0], ac, ad}, low_b[3] = {*below[1], bc, bd};
    const ClipVertex high_c[3] = {*above[0], ac, bc}, high_d[3] = {*above[1], ad, bd};
    wedge(axis, low_a, low_b);
    wedge(axis, high_c, high_d);
  }
  const std::array<ptrdiff_t, 3>&lo_, &hi_;
  Emit& emit_;
  ptrdiff_t at_[3] = {0, 0, 0};
};

}  // namespace sg
