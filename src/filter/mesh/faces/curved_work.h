// SPDX-License-Identifier: Apache-2.0
// Scratch memory of CurvedSkin for one face or curve. Inside filter/mesh only.
#pragma once
#include <cmath>
#include <vector>

#include "filter/mesh/faces/curved_faces.h"

namespace sg::detail {

/// Values at the grid's points, each in units of its tolerance: position first.
struct CurvedSkin::Work {
  size_t width = 3;
  int known = -1;  // the grid halved so often has values
  std::vector<double> nodes, points, shares;
  const double* at(size_t p) const { return points.data() + p * width; }
  Vec3 position(size_t p) const { return {at(p)[0], at(p)[1], at(p)[2]}; }

  // How far the middle m lies from the middle of a and b.
  double bend(size_t a, size_t b, size_t m) const { return bend(0.5, at(a), at(b), at(a), at(b), at(m)); }
  double bend4(size_t a, size_t b, size_t c, size_t d, size_t m) const { return bend(0.25, at(a), at(b), at(c), at(d), at(m)); }
  double apart(size_t a, size_t b) const { return length(position(a) - position(b)); }

 private:
  double bend(double share, const double* a, const double* b, const double* c, const double* d, const double* m) const {
    double worst = 0, far2 = 0;
    for (size_t k = 0; k < width; ++k) {
      const double mean = share == 0.5 ? 0.5 * (a[k] + b[k]) : 0.25 * (a[k] + b[k] + c[k] + d[k]);
      const double off = std::abs(m[k] - mean);
      if (k < 3) far2 += off * off;
      else if (off > worst) worst = off;
    }
    return std::max(worst, std::sqrt(far2));
  }
};

}  // namespace sg::detail
