// SPDX-License-Identifier: Apache-2.0
#include "render/volume/methods/spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "data/memory/memo.h"
#include "render/volume/methods/fft.h"

namespace sg::volume {

namespace {

using std::numbers::pi;
constexpr size_t lanes = 4;  // series that are transformed at once
using Lanes = float __attribute__((vector_size(16)));

/// Bessel's function by its series.
double bessel_i0(double x) {
  double sum = 1, term = 1;
  for (int n = 1; n < 60; ++n) term *= (0.5 * x / n) * (0.5 * x / n), sum += term;
  return sum;
}

/// sinh(x)/x for x^2 = square, sin(x)/x below zero.
double sinh_over(double square) {
  double sum = 1, term = 1;
  for (int n = 1; n < 60; ++n) term *= square / double(2 * n * (2 * n + 1)), sum += term;
  return sum;
}

struct Scratch {
  std::vector<Lanes> re, im, work_re, work_im;
  explicit Scratch(size_t n) : re(n), im(n), work_re(n), work_im(n) {}
};

}  // namespace

// Beta for a padding of two: Beatty, Nishimura and Pauly 2005.
SpectrumFilter::SpectrumFilter() : beta_(pi * std::sqrt(width * width / 4.0 * 2.25 - 0.8)), scale_(1 / bessel_i0(beta_)) {
  const int count = width / 2 * per_point;
  const auto h = [&](double x) {
    const double r = 1 - 4 * x * x / (width * width);
    return r > 0 ? scale_ * (bessel_i0(beta_ * std::sqrt(r)) - 1) : 0.0;
  };
  for (int i = 0; i < count + 2; ++i) {
    const double x = double(std::min(i, count)) / per_point, d = 1e-4;
    value_.push_back(float(h(x)));
    slope_.push_back(float(i == 0 ? 0 : x + d < 0.5 * width ? (h(x + d) - h(x - d)) / (2 * d) : (h(x) - h(x - d)) / d));
  }
}

void SpectrumFilter::at(double distance, float& value, float& slope) const {
  const double x = std::min(std::abs(distance), 0.5 * width) * per_point;
  const size_t i = size_t(x);
  const float f = float(x - double(i));
  value = value_[i] + f * (value_[i + 1] - value_[i]);
  slope = slope_[i] + f * (slope_[i + 1] - slope_[i]);
  if (distance < 0) slope = -slope;
}

double SpectrumFilter::window(double place) const {
  const double across = pi * width * place;
  return width * scale_ * (sinh_over(beta_ * beta_ - across * across) - sinh_over(-across * across));
}

size_t Spectrum::bytes_of(const Stage& stage) {
  size_t n[3];
  for (size_t a = 0; a < 3; ++a) n[a] = fft_size(2 * stage.volume.voxels.dims[a]);
  return (n[0] / 2 + 1) * n[1] * n[2] * sizeof(Value);
}

std::shared_ptr<const Spectrum> Spectrum::of(const Stage& s, Of what) {
  Memo& memo = s.item.data->memo();
  const std::string key =
      fmt::format("fourier{} {} {} {}", what == Of::ones ? " ones" : "", s.item.field, int(s.item.association), s.item.component);
  if (auto kept = memo.find<Spectrum>(key)) return kept;
  const size_t bytes = bytes_of(s), limit = s.context.memory_limit;
  if (limit > 0 && bytes > limit)
    fail_usage(fmt::format("the padded spectrum needs {} MB, more than the memory limit of {} MB", bytes >> 20, limit >> 20), "volume",
               "use method=ray, which needs only the volume itself");
  if (limit > 0 && bytes > limit / 2) return std::make_shared<const Spectrum>(s, what);
  return memo.keep(key, Spectrum(s, what), bytes);
}

Spectrum::Spectrum(const Stage& s, Of what) {
  dims_ = s.volume.voxels.dims;
  for (size_t a = 0; a < 3; ++a) size_[a] = fft_size(2 * dims_[a]), centre_[a] = dims_[a] / 2;
  half_ = size_[0] / 2 + 1;
  points_.resize(half_ * size_[1] * size_[2]);
  transform_x(s, what);
  s.context.check();
  transform_y();
  s.context.check();
  transform_z(s.context);
}

/// Rows of samples, eight at a time: four in the real parts, four in the imaginary ones, distinguished by their symmetry.
void Spectrum::transform_x(const Stage& s, Of what) {
  const Volume& v = s.volume;
  std::vector<float> weight[3];
  for (int a = 0; a < 3; ++a)
    for (size_t i = 0; i < dims_[size_t(a)]; ++i) {
      const double share = std::max(0.0, std::min(v.hi[a], double(i) + 0.5) - std::max(v.lo[a], double(i) - 0.5));
      weight[a].push_back(float(share / filter_.window((double(i) - double(centre_[a])) / double(size_[size_t(a)]))));
    }
  const Fft<float> fft(size_[0]);
  const size_t n = size_[0], rows = dims_[1] * dims_[2];
  parallel_for((rows + 2 * lanes - 1) / (2 * lanes), 8, [&](size_t begin, size_t end) {
    Scratch t(n);
    for (size_t b = begin; b < end; ++b) {
      std::fill(t.re.begin(), t.re.end(), Lanes{}), std::fill(t.im.begin(), t.im.end(), Lanes{});
      const size_t first = 2 * lanes * b, last = std::min(rows, first + 2 * lanes);
      for (size_t row = first; row < last; ++row) {
        const size_t j = row % dims_[1], k = row / dims_[1], lane = (row - first) % lanes;
        const float w = weight[1][j] * weight[2][k];
        std::vector<Lanes>& to = row - first < lanes ? t.re : t.im;
        for (size_t i = 0; i < dims_[0]; ++i) {
          const float value = value_at(v, i, j, k) + v.base;
          to[shifted(0, i)][lane] = value == value ? (what == Of::ones ? 1 : value) * w * weight[0][i] : 0;
        }
      }
      fft.transform(t.re.data(), t.im.data(), t.work_re.data(), t.work_im.data());
      for (size_t row = first; row < last; ++row) {
        const size_t j = row % dims_[1], k = row / dims_[1], lane = (row - first) % lanes;
        Value* out = &points_[half_ * (shifted(1, j) + size_[1] * shifted(2, k))];
        for (size_t x = 0; x < half_; ++x) {
          const size_t mirror = (n - x) % n;
          const float a = t.re[x][lane], bi = t.im[x][lane], c = t.re[mirror][lane], d = t.im[mirror][lane];
          if (row - first < lanes) out[x] = {0.5f * (a + c), 0.5f * (bi - d)};
          else out[x] = {0.5f * (bi + d), 0.5f * (c - a)};
        }
      }
    }
  });
}

void Spectrum::transform_y() {
  const Fft<float> fft(size_[1]);
  const size_t n = size_[1];
  parallel_for(dims_[2], 1, [&](size_t begin, size_t end) {
    Scratch t(n);
    for (size_t k = begin; k < end; ++k) {
      Value* plane = &points_[half_ * n * shifted(2, k)];
      for (size_t x = 0; x < half_; x += lanes) {
        const size_t count = std::min(lanes, half_ - x);
        std::fill(t.re.begin(), t.re.end(), Lanes{}), std::fill(t.im.begin(), t.im.end(), Lanes{});
        for (size_t j = 0; j < dims_[1]; ++j) {
          const size_t y = shifted(1, j);
          for (size_t c = 0; c < count; ++c) t.re[y][c] = plane[half_ * y + x + c].re, t.im[y][c] = plane[half_ * y + x + c].im;
        }
        fft.transform(t.re.data(), t.im.data(), t.work_re.data(), t.work_im.data());
        for (size_t y = 0; y < n; ++y)
          for (size_t c = 0; c < count; ++c) plane[half_ * y + x + c] = {t.re[y][c], t.im[y][c]};
      }
    }
  });
}

void Spectrum::transform_z(const Context& context) {
  const Fft<float> fft(size_[2]);
  const size_t n = size_[2], layer = half_ * size_[1];
  parallel_for(
      size_[1], 4,
      [&](size_t begin, size_t end) {
        Scratch t(n);
        for (size_t y = begin; y < end; ++y)
          for (size_t x = 0; x < half_; x += lanes) {
            const size_t count = std::min(lanes, half_ - x);
            Value* column = &points_[half_ * y + x];
            std::fill(t.re.begin(), t.re.end(), Lanes{}), std::fill(t.im.begin(), t.im.end(), Lanes{});
            for (size_t k = 0; k < dims_[2]; ++k) {
              const size_t z = shifted(2, k);
              for (size_t c = 0; c < count; ++c) t.re[z][c] = column[layer * z + c].re, t.im[z][c] = column[layer * z + c].im;
            }
            fft.transform(t.re.data(), t.im.data(), t.work_re.data(), t.work_im.data());
            for (size_t z = 0; z < n; ++z)
              for (size_t c = 0; c < count; ++c) column[layer * z + c] = {t.re[z][c], t.im[z][c]};
          }
      },
      &context);
}

Spectrum::Value Spectrum::point(size_t x, size_t y, size_t z) const {
  if (x < half_) return points_[x + half_ * (y + size_[1] * z)];
  const Value v = points_[size_[0] - x + half_ * ((size_[1] - y) % size_[1] + size_[1] * ((size_[2] - z) % size_[2]))];
  return {v.re, -v.im};
}

template <bool slopes>
std::array<Spectrum::Value, 4> Spectrum::read(Vec3 k) const {
  constexpr int width = SpectrumFilter::width;
  float h[3][width], d[3][width];
  size_t at[3][width];
  for (int a = 0; a < 3; ++a) {
    const double n = double(size_[size_t(a)]), place = (k[a] - std::floor(k[a])) * n, first = std::ceil(place - 0.5 * width);
    for (int i = 0; i < width; ++i) {
      filter_.at(place - (first + i), h[a][i], d[a][i]);
      const ptrdiff_t index = ptrdiff_t(first) + i, size = ptrdiff_t(size_[size_t(a)]);
      at[a][i] = size_t(index < 0 ? index + size : index >= size ? index - size : index);
      d[a][i] *= float(n);  // per turn
    }
  }
  std::array<Value, 4> sum{};
  for (int z = 0; z < width; ++z)
    for (int y = 0; y < width; ++y) {
      // Points with x beyond the half are conjugates of their opposites.
      const Value* row = &points_[half_ * (at[1][y] + size_[1] * at[2][z])];
      const Value* opposite = &points_[half_ * ((size_[1] - at[1][y]) % size_[1] + size_[1] * ((size_[2] - at[2][z]) % size_[2]))];
      Value s{}, t{};
      for (int x = 0; x < width; ++x) {
        const bool stored = at[0][x] < half_;
        const Value v = stored ? row[at[0][x]] : opposite[size_[0] - at[0][x]];
        const float im = stored ? v.im : -v.im;
        s.re += h[0][x] * v.re, s.im += h[0][x] * im;
        if (slopes) t.re += d[0][x] * v.re, t.im += d[0][x] * im;
      }
      const float w = h[1][y] * h[2][z];
      sum[0].re += w * s.re, sum[0].im += w * s.im;
      if (!slopes) continue;
      const float wy = d[1][y] * h[2][z], wz = h[1][y] * d[2][z];
      sum[1].re += w * t.re, sum[1].im += w * t.im;
      sum[2].re += wy * s.re, sum[2].im += wy * s.im;
      sum[3].re += wz * s.re, sum[3].im += wz * s.im;
    }
  return sum;
}

Spectrum::Value Spectrum::at(Vec3 k) const { return read<false>(k)[0]; }
std::array<Spectrum::Value, 4> Spectrum::with_slopes(Vec3 k) const { return read<true>(k); }

}  // namespace sg::volume
