// SPDX-License-Identifier: Apache-2.0
// The cells between samples that a ray passes, in order.
#pragma once
#include <algorithm>
#include <cmath>

#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

/// Box i of an axis goes from sample i to i+1; -1 and n-1 are the halves beyond the outermost samples (of cell fields and of axes with one
/// sample), where places are clamped to the outermost sample.
class BoxWalk {
 public:
  explicit BoxWalk(const Volume& v) : v_(v) {
    for (int a = 0; a < 3; ++a) last_[a] = long(v.voxels.dims[size_t(a)]) - 1;
  }

  void start(Vec3 origin, Vec3 direction, double from, double to) {
    c_ = course(v_, origin, direction, from, to);
    t_ = c_.enter, leave_ = t_;
    for (int a = 0; a < 3; ++a) {
      per_along_[a] = c_.along[a] != 0 ? 1 / c_.along[a] : 0;
      box_[a] = box_at(a, c_.start[a] + t_ * c_.along[a]);
      next_[a] = crossing(a);
    }
    leave_ = std::min({next_[0], next_[1], next_[2], c_.leave});
  }
  bool done() const { return !(t_ < c_.leave); }
  void advance() {
    t_ = leave_;
    if (done()) return;
    for (int a = 0; a < 3; ++a)
      if (next_[a] <= t_) box_[a] += c_.along[a] > 0 ? 1 : -1, next_[a] = crossing(a);
    leave_ = std::min({next_[0], next_[1], next_[2], c_.leave});
  }

  const Course& course_of_ray() const { return c_; }
  double from() const { return t_; }
  double to() const { return leave_; }
  double place(int a, double t) const { return c_.start[a] + t * c_.along[a]; }  // in q
  /// The cell of samples from which the box takes its values.
  long cell(int a) const { return clamped_cell(a, box_[a]); }
  long clamped_cell(int a, long box) const { return std::clamp<long>(box, 0, last_[a] - 1); }
  long box_at(int a, double q) const {
    if (q < sample(a, 0)) return -1;
    if (q >= sample(a, last_[a])) return q > sample(a, last_[a]) ? last_[a] : last_[a] - 1;
    if (v_.affine) return std::min(long(q), last_[a] - 1);
    const std::vector<double>& c = v_.coordinates[a];
    long i = std::min(long(v_.u(a, q)), last_[a] - 1);
    while (i > 0 && c[size_t(i)] > q) --i;
    while (i + 1 < last_[a] && c[size_t(i) + 1] <= q) ++i;
    return i;
  }
  double sample(int a, long i) const { return v_.affine ? double(i) : v_.coordinates[a][size_t(i)]; }
  double fraction(int a, long cell, double q) const {
    const double f = sample(a, cell), edge = sample(a, cell + 1) - f;
    return std::clamp(edge > 0 ? (q - f) / edge : 0, 0.0, 1.0);
  }
  /// t at which the ray passes the middle between the samples of a cell; infinite when it does not.
  double middle(int a, long cell) const {
    if (c_.along[a] == 0) return HUGE_VAL;
    return (0.5 * (sample(a, cell) + sample(a, cell + 1)) - c_.start[a]) * per_along_[a];
  }

 private:
  double side(int a, long i) const { return i < 0 ? -HUGE_VAL : i > last_[a] ? HUGE_VAL : sample(a, i); }
  double crossing(int a) const {
    if (c_.along[a] == 0) return HUGE_VAL;
    return std::max((side(a, box_[a] + (c_.along[a] > 0)) - c_.start[a]) * per_along_[a], t_);
  }

  const Volume& v_;
  long last_[3];
  Course c_;
  Vec3 per_along_;
  double t_ = 0, leave_ = -1, next_[3] = {};
  long box_[3] = {};
};

}  // namespace sg::volume
