// SPDX-License-Identifier: Apache-2.0
// Samples to bits: one streaming pass.
#include <cmath>
#include <type_traits>

#include "base/parallel.h"
#include "filter/scalar/contour/contour_parts.h"
#include "filter/scalar/contour/lattice/contour_bits.h"

namespace sg::contouring {

namespace {

// The smallest T for which x >= value holds exactly when x >= it; `none` when there is no such number.
template <class T>
T threshold(double value, bool& none) {
  none = false;
  if constexpr (std::is_floating_point_v<T>) {
    T t = T(value);
    if (double(t) < value) t = std::nextafter(t, std::numeric_limits<T>::infinity());
    return t;
  } else {
    const double up = std::ceil(value);
    none = up > double(std::numeric_limits<T>::max());
    return up < double(std::numeric_limits<T>::min()) ? std::numeric_limits<T>::min() : none ? T(0) : T(up);
  }
}

template <class F>
decltype(auto) native(const Array& a, F&& f) {
  switch (a.type()) {
    case ElementType::u8: return f(a.view<uint8_t>().data);
    case ElementType::i8: return f(a.view<int8_t>().data);
    case ElementType::u16: return f(a.view<uint16_t>().data);
    case ElementType::i16: return f(a.view<int16_t>().data);
    case ElementType::f32: return f(a.view<float>().data);
    default: return f(a.view<double>().data);
  }
}

size_t row_grain(size_t nx) { return std::max<size_t>(1, 65536 / std::max<size_t>(nx, 1)); }

}  // namespace

bool classify(const Array& samples, size_t nx, size_t rows, std::span<const double> values, std::span<const RowsOut> out, size_t words,
              Context& context) {
  return native(samples, [&](const auto* p) {
    using T = std::remove_cvref_t<decltype(*p)>;
    std::vector<std::pair<T, bool>> least;  // and whether no sample can be that large
    for (double v : values) {
      bool none = false;
      const T t = threshold<T>(v, none);
      least.emplace_back(t, none);
    }
    return parallel_reduce(
        rows, row_grain(nx), false,
        [&](size_t begin, size_t end) {
          bool nan = false;
          for (size_t r = begin; r < end; ++r) {
            const T* row = p + r * nx;
            for (size_t v = 0; v < values.size(); ++v) {
              uint64_t* bits = out[v].bits + r * words;
              if (!least[v].second) at_least(BitRows<T>{row, nx, 1, least[v].first, bits, words, out[v].state + r});
              else std::fill(bits, bits + words, 0), out[v].state[r] = RowState::outside;
            }
            if constexpr (std::is_floating_point_v<T>) nan = nan || any_nan(row, nx);
          }
          return nan;
        },
        [](bool a, bool b) { return a || b; }, &context);
  });
}

void classify_known(const Array& samples, size_t nx, size_t rows, const StretchRanges& ranges, double value, RowsOut out, size_t words,
                    Context& context) {
  native(samples, [&]<class T>(const T* all) {
    bool none = false;
    const T least = threshold<T>(value, none);
    parallel_for(
        rows, row_grain(nx),
        [&](size_t begin, size_t end) {
          uint64_t* bits = out.bits + begin * words;
          if (!none)
            return at_least(BitRows<T>{all + begin * nx, nx, end - begin, least, bits, words, out.state + begin, &ranges, begin,
                                       ranges.level(float(least))});
          std::fill(bits, out.bits + end * words, 0);
          std::fill(out.state + begin, out.state + end, RowState::outside);
        },
        &context);
  });
}

// There are as many levels as bytes can distinguish, spread over the middle 98 % of some stretches; the rest takes the first and the last
// one.
void find_levels(StretchRanges& r, const Array& samples) {
  const Sample f(samples);
  const size_t n = samples.count(), step = std::max<size_t>(1, n / 4096);
  std::vector<float> some;
  for (size_t i = step / 2; i < n; i += step)
    if (const auto x = float(f(i)); std::isfinite(x)) some.push_back(x);
  if (some.empty()) return;
  const auto place = [&](size_t at) {
    std::nth_element(some.begin(), some.begin() + ptrdiff_t(at), some.end());
    return some[at];
  };
  const float lo = place(some.size() / 100), hi = place(some.size() - 1 - some.size() / 100);
  r.first = lo;
  r.scale = hi > lo ? 254 / (hi - lo) : 0;
  if (!std::isfinite(r.scale) || !(r.scale > 0)) r.scale = 1;
}

StretchRanges find_ranges(const Array& samples, size_t nx, size_t rows, bool& missing, Context& context) {
  StretchRanges r;
  const size_t stretches = (nx + StretchRanges::length - 1) / StretchRanges::length;
  r.per_row = (nx + 63) / 64 * 4;
  r.lo.resize(r.per_row * rows + 16), r.hi.resize(r.per_row * rows + 16);
  find_levels(r, samples);
  missing = native(samples, [&]<class T>(const T* p) {
    return parallel_reduce(
        rows, row_grain(nx), false,
        [&](size_t begin, size_t end) {
          bool nan = false;
          std::vector<float> lo(stretches), hi(stretches);
          for (size_t row = begin; row < end; ++row) {
            const bool here = stretch_ranges(p + row * nx, nx, lo.data(), hi.data());
            nan = nan || here;
            for (size_t s = 0; s < stretches; ++s) r.lo[row * r.per_row + s] = r.level(lo[s]);
            for (size_t s = 0; s < stretches; ++s) r.hi[row * r.per_row + s] = r.level(hi[s]);
          }
          return nan;
        },
        [](bool a, bool b) { return a || b; }, &context);
  });
  return r;
}

void find_missing(const Array& samples, size_t nx, size_t rows, uint64_t* bits, size_t words, Context& context) {
  const Sample f(samples);
  parallel_for(
      rows, row_grain(nx),
      [&](size_t begin, size_t end) {
        for (size_t r = begin; r < end; ++r)
          for (size_t i = 0; i < nx; ++i) bits[r * words + i / 64] |= uint64_t(std::isnan(f(r * nx + i))) << (i % 64);
      },
      &context);
}

}  // namespace sg::contouring
