// SPDX-License-Identifier: Apache-2.0
#include "filter/field/sampling/reconstruction.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

namespace {

constexpr KernelTraits all[] = {
    {1, true, false, false, 0}, {1, true, true, false, 1},  {2, true, true, false, 3},    {2, false, true, false, 3},
    {2, true, true, true, 3},   {2, false, true, false, 3}, {2, false, false, false, -1}, {3, true, false, false, -1},
};
constexpr double sigma = 0.6, gauss_end = 2;

double sinc(double t) { return std::abs(t) < 1e-4 ? 1 - M_PI * M_PI * t * t / 6 : std::sin(M_PI * t) / (M_PI * t); }
double sinc_slope(double t) {
  if (std::abs(t) < 1e-3) return -M_PI * M_PI * t / 3 * (1 - M_PI * M_PI * t * t / 10);
  return (std::cos(M_PI * t) - sinc(t)) / t;
}

}  // namespace

const KernelTraits& traits(Kernel k) { return all[size_t(k)]; }

double bc_spline(double b, double c, double t) {
  t = std::abs(t);
  if (t >= 2) return 0;
  if (t < 1) return ((12 - 9 * b - 6 * c) * t * t * t + (-18 + 12 * b + 6 * c) * t * t + 6 - 2 * b) / 6;
  return ((-b - 6 * c) * t * t * t + (6 * b + 30 * c) * t * t + (-12 * b - 48 * c) * t + 8 * b + 24 * c) / 6;
}

double bc_spline_slope(double b, double c, double t) {
  const double u = std::abs(t), sign = t < 0 ? -1 : 1;
  if (u >= 2) return 0;
  if (u < 1) return sign * ((36 - 27 * b - 18 * c) * u * u + (-36 + 24 * b + 12 * c) * u) / 6;
  return sign * ((-3 * b - 18 * c) * u * u + (12 * b + 60 * c) * u - 12 * b - 48 * c) / 6;
}

double kernel_value(Kernel k, double t) {
  switch (k) {
    case Kernel::nearest: return t > -0.5 && t <= 0.5 ? 1 : 0;
    case Kernel::linear: return std::max(0.0, 1 - std::abs(t));
    case Kernel::catmull_rom: return bc_spline(0, 0.5, t);
    case Kernel::mitchell: return bc_spline(1.0 / 3, 1.0 / 3, t);
    case Kernel::bspline:
    case Kernel::bspline_smooth: return bc_spline(1, 0, t);
    case Kernel::gaussian:
      if (std::abs(t) >= gauss_end) return 0;
      return std::exp(-t * t / (2 * sigma * sigma)) - std::exp(-gauss_end * gauss_end / (2 * sigma * sigma));
    case Kernel::sinc: return std::abs(t) >= 3 ? 0 : sinc(t) * sinc(t / 3);
  }
  return 0;
}

double kernel_slope(Kernel k, double t) {
  switch (k) {
    case Kernel::nearest: return 0;
    case Kernel::linear: return std::abs(t) > 1 || t == 0 ? 0 : t < 0 ? 1 : -1;
    case Kernel::catmull_rom: return bc_spline_slope(0, 0.5, t);
    case Kernel::mitchell: return bc_spline_slope(1.0 / 3, 1.0 / 3, t);
    case Kernel::bspline:
    case Kernel::bspline_smooth: return bc_spline_slope(1, 0, t);
    case Kernel::gaussian: return std::abs(t) >= gauss_end ? 0 : -t / (sigma * sigma) * std::exp(-t * t / (2 * sigma * sigma));
    case Kernel::sinc: return std::abs(t) >= 3 ? 0 : sinc_slope(t) * sinc(t / 3) + sinc(t) * sinc_slope(t / 3) / 3;
  }
  return 0;
}

void kernel_weights(Kernel k, double f, double* w) {
  const int radius = traits(k).radius, taps = 2 * radius;
  if (k == Kernel::nearest) {
    w[0] = f < 0.5, w[1] = !(f < 0.5);
    return;
  }
  double sum = 0;
  for (int i = 0; i < taps; ++i) sum += w[i] = kernel_value(k, f - (i + 1 - radius));
  if (traits(k).degree < 0)
    for (int i = 0; i < taps; ++i) w[i] /= sum;
}

void kernel_slopes(Kernel k, double f, double* d) {
  const int radius = traits(k).radius, taps = 2 * radius;
  if (k == Kernel::linear) {
    d[0] = -1, d[1] = 1;
    return;
  }
  double w[most_taps], sum = 0, change = 0;
  for (int i = 0; i < taps; ++i) {
    const double t = f - (i + 1 - radius);
    sum += w[i] = kernel_value(k, t), change += d[i] = kernel_slope(k, t);
  }
  if (traits(k).degree < 0)
    for (int i = 0; i < taps; ++i) d[i] = (d[i] - w[i] * change / sum) / sum;
}

double kernel_gain(Kernel k) {
  double most = 1, w[most_taps];
  for (int i = 0; i <= 512; ++i) {
    kernel_weights(k, i / 512.0, w);
    double sum = 0;
    for (int j = 0; j < 2 * traits(k).radius; ++j) sum += std::abs(w[j]);
    most = std::max(most, sum);
  }
  // Between the places looked at it is a little more at most.
  return most > 1 + 1e-9 ? most + 1e-4 : 1;
}

namespace {

constexpr size_t columns = 32;  // lines that are filtered side by side

/// n samples of each of `width` lines that lie side by side; those of a line `stride` apart. The straight line through the ends is taken
/// off: what is left is reflected as an odd function at both of them, and so are the sums of the filter.
void filter_lines(float* at, size_t n, size_t stride, size_t width) {
  constexpr double z = -0.26794919243112270647;  // sqrt(3) - 2, the pole
  constexpr size_t horizon = 28;                 // |z|^28 < 1e-16
  double first[columns], slope[columns], run[columns];
  std::vector<float> sums(n * width);
  for (size_t c = 0; c < width; ++c) {
    first[c] = double(at[c]), slope[c] = (double(at[(n - 1) * stride + c]) - first[c]) / double(n - 1);
    // The part of the causal sum before the first sample: minus the sum of z^j d[j], d odd about both ends.
    double sum = 0, power = 1;
    for (size_t j = 1; j <= horizon; ++j) {
      power *= z;
      const size_t period = 2 * (n - 1), m = j % period, i = m < n ? m : period - m;
      const double d = double(at[i * stride + c]) - (first[c] + slope[c] * double(i));
      sum -= power * (m < n ? d : -d);
    }
    run[c] = 6 * sum;
    sums[c] = float(run[c]);
  }
  for (size_t i = 1; i + 1 < n; ++i)
    for (size_t c = 0; c < width; ++c) {
      run[c] = 6 * (double(at[i * stride + c]) - (first[c] + slope[c] * double(i))) + z * run[c];
      sums[i * width + c] = float(run[c]);
    }
  std::fill(run, run + width, 0.0);  // the last coefficient of an odd function
  for (size_t i = n - 1; i-- > 1;)
    for (size_t c = 0; c < width; ++c) {
      run[c] = z * (run[c] - double(sums[i * width + c]));
      at[i * stride + c] = float(run[c] + first[c] + slope[c] * double(i));
    }
}

}  // namespace

void bspline_coefficients_along(size_t axis, float* values, std::array<size_t, 3> dims, const Context* context) {
  const size_t n = dims[axis], count = dims[0] * dims[1] * dims[2];
  if (n < 3 || count == 0) return;  // the line through two samples needs no filter
  const size_t stride = axis == 0 ? 1 : axis == 1 ? dims[0] : dims[0] * dims[1];
  // Lines along x lie behind each other, others side by side.
  const size_t width = axis == 0 ? 1 : std::min(columns, stride), per_row = (stride + width - 1) / width, rows = count / (stride * n);
  parallel_for(
      rows * per_row, std::max<size_t>(1, 16384 / (n * width)),
      [&](size_t begin, size_t end) {
        for (size_t b = begin; b < end; ++b) {
          const size_t x = b % per_row * width;
          filter_lines(values + b / per_row * stride * n + x, n, stride, std::min(width, stride - x));
        }
      },
      context);
}

void bspline_coefficients(float* values, std::array<size_t, 3> dims, const Context* context) {
  for (size_t a = 0; a < 3; ++a) bspline_coefficients_along(a, values, dims, context);
}

namespace {

/// What a missing sample gets from the samples that have a value (`state` 0); NaN when none is near.
float filled(const float* values, const uint8_t* state, const std::array<size_t, 3>& dims, const long at[3]) {
  double straight = 0, near = 0;
  int straights = 0, nears = 0;
  const auto value = [&](long i, long j, long k, double& v) {
    if (i < 0 || j < 0 || k < 0 || i >= long(dims[0]) || j >= long(dims[1]) || k >= long(dims[2])) return false;
    const size_t p = size_t(i) + dims[0] * (size_t(j) + dims[1] * size_t(k));
    if (state[p] != 0) return false;
    v = double(values[p]);
    return true;
  };
  for (int d = 0; d < 27; ++d) {
    const long x = d % 3 - 1, y = d / 3 % 3 - 1, z = d / 9 - 1;
    double one = 0, two = 0;
    if (d == 13 || !value(at[0] + x, at[1] + y, at[2] + z, one)) continue;
    near += one, ++nears;
    if (value(at[0] + 2 * x, at[1] + 2 * y, at[2] + 2 * z, two)) straight += 2 * one - two, ++straights;
  }
  return straights > 0 ? float(straight / straights) : nears > 0 ? float(near / nears) : NAN;
}

}  // namespace

std::vector<uint8_t> fill_holes(float* values, std::array<size_t, 3> dims, int layers, const Context* context) {
  const size_t count = dims[0] * dims[1] * dims[2], row = dims[0];
  struct Seen {
    float lo = HUGE_VALF, hi = -HUGE_VALF;
    bool holes = false;
  };
  const Seen seen = parallel_reduce(
      count, 65536, Seen{},
      [&](size_t begin, size_t end) {
        Seen s;
        for (size_t i = begin; i < end; ++i) {
          if (std::isfinite(values[i])) s.lo = std::min(s.lo, values[i]), s.hi = std::max(s.hi, values[i]);
          else s.holes = true;
        }
        return s;
      },
      [](Seen a, Seen b) {
        return Seen{std::min(a.lo, b.lo), std::max(a.hi, b.hi), a.holes || b.holes};
      },
      context);
  if (!seen.holes) return {};
  std::vector<uint8_t> missing(count);
  for (size_t i = 0; i < count; ++i) missing[i] = !std::isfinite(values[i]);
  std::vector<uint8_t> state = missing;
  for (int layer = 0; layer < layers; ++layer) {
    // Those filled now take their values from earlier layers: state 2 until the layer is done.
    parallel_for(
        dims[1] * dims[2], 16,
        [&](size_t begin, size_t end) {
          for (size_t r = begin; r < end; ++r)
            for (size_t i = 0; i < row; ++i) {
              if (missing[r * row + i] == 0 || state[r * row + i] == 0) continue;
              const long at[3] = {long(i), long(r % dims[1]), long(r / dims[1])};
              const float v = filled(values, state.data(), dims, at);
              if (v == v) values[r * row + i] = v;
            }
        },
        context);
    for (size_t i = 0; i < count; ++i)
      if (state[i] != 0 && std::isfinite(values[i])) state[i] = 0;
  }
  const float middle = seen.lo <= seen.hi ? 0.5f * seen.lo + 0.5f * seen.hi : 0;
  for (size_t i = 0; i < count; ++i)
    if (state[i] != 0) values[i] = middle;
  return missing;
}

}  // namespace sg
