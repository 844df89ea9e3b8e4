// SPDX-License-Identifier: Apache-2.0
#include "data/cells/shape/multilinear_part.h"

#include <algorithm>

namespace sg {

namespace {

// Whether zero lies beyond all of the numbers by more than their spread times `margin`.
struct Reach {
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  void add(double v) { lo = std::min(lo, v), hi = std::max(hi, v); }
  bool misses_zero(double margin) const {
    const double m = margin * (hi - lo);
    return lo > m || hi < -m;
  }
};

}  // namespace

bool MultilinearPart::excludes(Vec3 x, double margin) const {
  std::array<Vec3, 8> d;
  Reach along[3];
  for (size_t c = 0; c < 8; ++c) {
    d[c] = corner[c] - x;
    for (int a = 0; a < 3; ++a) along[a].add(d[c][a]);
  }
  for (const Reach& r : along)
    if (r.misses_zero(margin)) return true;
  Vec3 edge[3];  // the sums of the edges along each axis: four times the Jacobian in the middle
  for (size_t c = 0; c < 8; ++c)
    for (size_t a = 0; a < 3; ++a) edge[a] += c >> a & 1 ? d[c] : -d[c];
  for (int a = 0; a < 3; ++a) {
    const Vec3 normal = cross(edge[(a + 1) % 3], edge[(a + 2) % 3]);
    Reach r;
    for (const Vec3& v : d) r.add(dot(normal, v));
    if (r.misses_zero(margin)) return true;
  }
  return false;
}

void MultilinearPart::divide(std::array<MultilinearPart, 8>& eighths) const {
  std::array<Vec3, 27> at;  // corners, and the middles of edges, faces and the whole
  const auto place = [](size_t i, size_t j, size_t k) { return i + 3 * j + 9 * k; };
  for (size_t c = 0; c < 8; ++c) at[place(2 * (c & 1), 2 * (c >> 1 & 1), 2 * (c >> 2))] = corner[c];
  for (size_t k = 0; k < 3; k += 2)
    for (size_t j = 0; j < 3; j += 2) at[place(1, j, k)] = (at[place(0, j, k)] + at[place(2, j, k)]) * 0.5;
  for (size_t k = 0; k < 3; k += 2)
    for (size_t i = 0; i < 3; ++i) at[place(i, 1, k)] = (at[place(i, 0, k)] + at[place(i, 2, k)]) * 0.5;
  for (size_t m = 0; m < 9; ++m) at[9 + m] = (at[m] + at[18 + m]) * 0.5;
  for (size_t e = 0; e < 8; ++e)
    for (size_t c = 0; c < 8; ++c) eighths[e].corner[c] = at[place((e & 1) + (c & 1), (e >> 1 & 1) + (c >> 1 & 1), (e >> 2) + (c >> 2))];
}

}  // namespace sg
