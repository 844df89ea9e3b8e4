// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/pixel_flow.h"

#include "base/parallel.h"

namespace sg::texture {

PixelWeights::PixelWeights(int dimension, const int32_t* n, const double* x) : count(1 << dimension) {
  size_t base = 0, stride = 1, strides[3] = {};
  double f[3] = {};
  for (int a = 0; a < dimension; ++a) {
    const int32_t i = std::min(int32_t(x[a]), n[a] - 2);
    f[a] = x[a] - i, base += stride * size_t(i), strides[a] = stride;
    stride *= size_t(n[a]);
  }
  for (int k = 0; k < count; ++k) {
    pixel[k] = base, weight[k] = 1;
    for (int a = 0; a < dimension; ++a) {
      if (k >> a & 1) pixel[k] += strides[a];
      weight[k] *= k >> a & 1 ? f[a] : 1 - f[a];
    }
  }
}

PixelFlow::PixelFlow(const Frame& f, const Context& context) : dimension_(f.dimension), velocity_(velocity_of(f, context)) {
  std::copy_n(f.n, 3, n_);
  const size_t d = size_t(dimension_);
  const float most = parallel_reduce(
      f.size(), 1 << 14, 0.0f,
      [&](size_t begin, size_t end) {
        float m = 0;
        for (size_t i = begin; i < end; ++i) {
          float square = 0;
          for (size_t a = 0; a < d; ++a) square += velocity_[i * d + a] * velocity_[i * d + a];
          if (square > m) m = square;  // not NaN
        }
        return m;
      },
      [](float a, float b) { return std::max(a, b); }, &context);
  largest_speed_ = std::sqrt(double(most));
}

bool PixelFlow::has_value(size_t pixel) const {
  for (int a = 0; a < dimension_; ++a)
    if (!std::isfinite(velocity_[pixel * size_t(dimension_) + size_t(a)])) return false;
  return true;
}

bool PixelFlow::inside_with_holes(const double* x, double* v) const {
  const PixelWeights w(dimension_, n_, x);
  double sum = 0;
  for (int a = 0; a < dimension_; ++a) {
    v[a] = 0;
    for (int k = 0; k < w.count; ++k)
      if (w.weight[k] > 0) v[a] += w.weight[k] * double(velocity_[w.pixel[k] * size_t(dimension_) + size_t(a)]);
    sum += v[a];
  }
  return std::isfinite(sum);
}

}  // namespace sg::texture
