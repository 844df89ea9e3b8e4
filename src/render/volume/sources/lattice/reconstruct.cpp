// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/lattice/reconstruct.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "render/volume/sources/lattice/samples.h"

namespace sg::volume {

TapPolynomials::TapPolynomials(Kernel kernel) : taps_(2 * traits(kernel).radius) {
  degree_ = traits(kernel).degree < 0 ? 9 : std::max(1, traits(kernel).degree);
  // Newton's interpolation at Chebyshev points, multiplied out; x = f - 1/2.
  const int n = degree_ + 1;
  double x[10], w[10][most_taps];
  for (int i = 0; i < n; ++i) {
    x[i] = 0.5 * std::cos(M_PI * (2 * i + 1) / (2.0 * n));
    kernel_weights(kernel, 0.5 + x[i], w[i]);
  }
  for (int t = 0; t < taps_; ++t) {
    double divided[10], power[10] = {};
    for (int i = 0; i < n; ++i) divided[i] = w[i][t];
    for (int level = 1; level < n; ++level)
      for (int i = n - 1; i >= level; --i) divided[i] = (divided[i] - divided[i - 1]) / (x[i] - x[i - level]);
    for (int i = n - 1; i >= 0; --i) {
      for (int k = n - 1; k > 0; --k) power[k] = power[k - 1] - x[i] * power[k];
      power[0] = divided[i] - x[i] * power[0];
    }
    for (int k = 0; k < n; ++k) c_[t][k] = float(power[k]);
  }
}

void TapPolynomials::at(const float* f, float* w) const {
  float x[lanes];
  for (int p = 0; p < lanes; ++p) x[p] = f[p] - 0.5f;
  for (int t = 0; t < taps_; ++t) {
    float sum[lanes];
    std::fill(sum, sum + lanes, c_[t][degree_]);
    for (int k = degree_ - 1; k >= 0; --k)
      for (int p = 0; p < lanes; ++p) sum[p] = sum[p] * x[p] + c_[t][k];
    std::copy(sum, sum + lanes, w + t * lanes);
  }
}

namespace {

/// Fills what lies beyond the ends of a line of n numbers `stride` apart that stands for the samples first, first+1, ... of `count`.
void reflect(float* line, int n, int stride, long first, long count) {
  const auto at = [&](long i) -> float& { return line[(i - first) * stride]; };
  const long last = count - 1;
  // Outward from both ends in turn: a reflected sample may lie beyond the other end, but nearer to it.
  for (long d = 1; d < n; ++d) {
    if (-d >= first) at(-d) = 2 * at(0) - at(d);
    if (last + d < first + n) at(last + d) = 2 * at(last) - at(last - d);
  }
}

template <class T>
void read_block_of(const T* samples, const std::array<size_t, 3>& dims, const long cell[3], int radius, float* block) {
  const int n = 2 * radius;
  long first[3], from[3], to[3];
  bool inside = true;
  for (int a = 0; a < 3; ++a) {
    first[a] = cell[a] + 1 - radius, from[a] = std::max(first[a], 0L), to[a] = std::min(first[a] + n, long(dims[size_t(a)]));
    inside = inside && to[a] - from[a] == n;
  }
  for (long k = from[2]; k < to[2]; ++k)
    for (long j = from[1]; j < to[1]; ++j) {
      const T* in = samples + dims[0] * (size_t(j) + dims[1] * size_t(k));
      float* out = block + n * (j - first[1] + n * (k - first[2])) - first[0];
      for (long i = from[0]; i < to[0]; ++i) out[i] = float(in[i]);
    }
  if (inside) return;
  for (long k = from[2]; k < to[2]; ++k)
    for (long j = from[1]; j < to[1]; ++j) reflect(block + n * (j - first[1] + n * (k - first[2])), n, 1, first[0], long(dims[0]));
  for (long k = from[2]; k < to[2]; ++k)
    for (int i = 0; i < n; ++i) reflect(block + i + n * n * (k - first[2]), n, n, first[1], long(dims[1]));
  for (int i = 0; i < n * n; ++i) reflect(block + i, n, n * n, first[2], long(dims[2]));
}

/// Ranges of samples, those outside the lattice included, that have a share in a brick.
template <class T>
MinMaxBricks wide_bricks(const T* samples, const std::array<size_t, 3>& dims, int radius, double widen) {
  MinMaxBricks b;
  for (size_t a = 0; a < 3; ++a) b.dims[a] = (dims[a] - 1 + MinMaxBricks::edge - 1) >> MinMaxBricks::shift;
  b.ranges.resize(b.dims[0] * b.dims[1] * b.dims[2]);
  parallel_for(b.size(), 8, [&](size_t begin, size_t end) {
    std::vector<float> block(size_t(8 * radius * radius * radius));
    for (size_t id = begin; id < end; ++id) {
      const size_t at[3] = {id % b.dims[0], id / b.dims[0] % b.dims[1], id / b.dims[0] / b.dims[1]};
      long from[3], to[3];
      bool inside = true;
      for (size_t a = 0; a < 3; ++a) {
        from[a] = long(at[a] << MinMaxBricks::shift), to[a] = std::min(from[a] + MinMaxBricks::edge, long(dims[a]) - 1);
        inside = inside && from[a] + 1 - radius >= 0 && to[a] + radius <= long(dims[a]);
      }
      float lo = HUGE_VALF, hi = -HUGE_VALF;
      const auto take = [&](float v) { lo = std::min(lo, v), hi = std::max(hi, v); };
      if (inside) {
        for (long k = from[2] + 1 - radius; k < to[2] + radius; ++k)
          for (long j = from[1] + 1 - radius; j < to[1] + radius; ++j) {
            const T* row = samples + dims[0] * (size_t(j) + dims[1] * size_t(k));
            for (long i = from[0] + 1 - radius; i < to[0] + radius; ++i) take(float(row[i]));
          }
      } else {
        // Blocks of some cells, which cover those between.
        long cell[3];
        const auto each = [&](int a, auto&& f) {
          for (cell[a] = from[a]; cell[a] < to[a]; cell[a] = cell[a] + 1 < to[a] ? std::min(cell[a] + 2 * radius - 1, to[a] - 1) : to[a])
            f();
        };
        each(2, [&] {
          each(1, [&] {
            each(0, [&] {
              read_block_of(samples, dims, cell, radius, block.data());
              for (float v : block) take(v);
            });
          });
        });
      }
      const double middle = 0.5 * (double(lo) + double(hi)), half = 0.5 * (double(hi) - double(lo)) * widen;
      const double rounding = 4e-6 * (std::abs(middle) + half);
      b.ranges[id] = {float(middle - half - rounding), float(middle + half + rounding)};
    }
  });
  return b;
}

}  // namespace

void read_block(const Reconstruction& r, const std::array<size_t, 3>& dims, const long cell[3], int radius, float* block) {
  with_samples(r.samples, [&](const auto* samples) { read_block_of(samples, dims, cell, radius, block); });
}

Reconstruction reconstruct(const Volume& volume, Kernel kernel) {
  Reconstruction r;
  r.kernel = kernel, r.samples = volume.voxels.array;
  const std::array<size_t, 3>& dims = volume.voxels.dims;
  const size_t count = r.samples.count();
  bool holes = false;
  if (r.samples.type() == ElementType::f32) {
    const View<float> v = r.samples.view<float>();
    holes = parallel_reduce(
        count, 65536, false,
        [&](size_t begin, size_t end) {
          bool any = false;
          for (size_t i = begin; i < end; ++i) any = any || !std::isfinite(v[i]);
          return any;
        },
        [](bool a, bool b) { return a || b; });
  }
  if (holes || traits(kernel).prefilter) {
    float* values = nullptr;
    Array own = Array::make<float>(count, 1, &values);
    with_samples(r.samples, [&](const auto* in) {
      parallel_for(count, 65536, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) values[i] = float(in[i]);
      });
    });
    // A filter reaches far; gradients and kernels one sample more than the radius.
    if (holes) r.missing = fill_holes(values, dims, traits(kernel).prefilter ? 8 : traits(kernel).radius + 1);
    if (traits(kernel).prefilter) bspline_coefficients(values, dims);
    r.samples = own;
  }
  const double gain = kernel_gain(kernel);
  r.bricks = with_samples(r.samples, [&](const auto* in) { return wide_bricks(in, dims, traits(kernel).radius, gain * gain * gain); });
  for (const MinMaxBricks::Range& b : r.bricks.ranges) r.lo = std::min(r.lo, double(b.lo)), r.hi = std::max(r.hi, double(b.hi));
  return r;
}

void gradient_rows(Kernel kernel, GradientKind kind, double f, double* slope, double* across) {
  const int radius = traits(kernel).radius, taps = 2 * radius;
  // w[m] of the sample 1 - (radius + 1) + m, nothing beyond.
  double room[most_taps + 6] = {}, *w = room + 3;
  kernel_weights(kernel, f, w);
  for (int m = 0; m < taps + 2; ++m) {
    across[m] = kind == GradientKind::sobel ? 0.25 * (w[m - 2] + 2 * w[m - 1] + w[m]) : w[m - 1];
    slope[m] = 0.5 * (w[m - 2] - w[m]);
  }
  if (kind == GradientKind::analytic) {
    double d[most_taps];
    kernel_slopes(kernel, f, d);
    slope[0] = slope[taps + 1] = 0;
    std::copy(d, d + taps, slope + 1);
  } else if (kind == GradientKind::intermediate) {
    std::fill(slope, slope + taps + 2, 0.0);
    double v[most_taps];
    const bool upper = f >= 0.5;  // half a sample further lies in the next cell
    kernel_weights(kernel, upper ? f - 0.5 : f + 0.5, v);
    for (int m = 0; m < taps; ++m) slope[m + 1 + upper] += v[m], slope[m + upper] -= v[m];
  }
}

}  // namespace sg::volume
