// SPDX-License-Identifier: Apache-2.0
// PixelFlow: the velocities of a frame at any place between its pixels.
#pragma once
#include "filter/flow/texture/frame.h"

namespace sg::texture {

/// Places and velocities in pixels. Linear along each axis between pixels.
class PixelFlow {
 public:
  PixelFlow(const Frame& frame, const Context& context);

  int dimension() const { return dimension_; }
  int32_t n(int axis) const { return n_[axis]; }
  double largest_speed() const { return largest_speed_; }     ///< not counting NaN
  const float* velocity() const { return velocity_.data(); }  ///< `dimension` numbers a pixel
  bool has_value(size_t pixel) const;

  /// The velocity; false outside of the grid and where it is NaN.
  bool at(const double* x, double* v) const {
    for (int a = 0; a < dimension_; ++a)
      if (!(x[a] >= 0 && x[a] <= n_[a] - 1)) return false;
    return inside(x, v);
  }
  /// Outside of the grid that of the nearest place on its border.
  bool at_nearest(const double* x, double* v) const {
    double y[3];
    for (int a = 0; a < dimension_; ++a) y[a] = x[a] < 0 ? 0 : x[a] > n_[a] - 1 ? n_[a] - 1 : x[a];
    return inside(y, v);
  }

 private:
  bool inside(const double* x, double* v) const {
    if (dimension_ == 2) {
      const int32_t i = std::min(int32_t(x[0]), n_[0] - 2), j = std::min(int32_t(x[1]), n_[1] - 2);
      const double f = x[0] - i, g = x[1] - j;
      const float *lower = &velocity_[2 * (size_t(i) + size_t(n_[0]) * size_t(j))], *upper = lower + 2 * size_t(n_[0]);
      for (int a = 0; a < 2; ++a)
        v[a] =
            (1 - g) * ((1 - f) * double(lower[a]) + f * double(lower[a + 2])) + g * ((1 - f) * double(upper[a]) + f * double(upper[a + 2]));
      if (std::isfinite(v[0] + v[1])) return true;
    }
    return inside_with_holes(x, v);
  }
  // Pixels that do not count (weight 0) may be without value.
  bool inside_with_holes(const double* x, double* v) const;
  int dimension_;
  int32_t n_[3];
  Plane<float> velocity_;
  double largest_speed_ = 0;
};

/// The pixels around a place inside the grid and their weights: 2^dimension of them.
struct PixelWeights {
  size_t pixel[8];
  double weight[8];
  int count;
  PixelWeights(int dimension, const int32_t* n, const double* x);
};

}  // namespace sg::texture
