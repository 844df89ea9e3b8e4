// SPDX-License-Identifier: Apache-2.0
// Samples to bits: one streaming pass.
#include <cmath>
#include <type_traits>

#include "base/parallel.h"
#include "filter/scalar/contour_bits.h"
#include "filter/scalar/contour_parts.h"

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

bool classify(const Array& samples, size_t nx, size_t rows, std::span<const double> values, std::span<uint64_t* const> bits, size_t words,
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
              uint64_t* out = bits[v] + r * words;
              if (least[v].second) std::fill(out, out + words, 0);
              else at_least(BitRows<T>{row, nx, 1, least[v].first, out, words});
            }
            if constexpr (std::is_floating_point_v<T>) nan = nan || any_nan(row, nx);
          }
          return nan;
        },
        [](bool a, bool b) { return a || b; }, &context);
  });
}

void classify_rows(const Array& samples, size_t nx, size_t row, size_t rows, double value, const uint8_t* wanted, const uint64_t* otherwise,
                   uint64_t* bits, size_t words) {
  native(samples, [&]<class T>(const T* all) {
    bool none = false;
    const T least = threshold<T>(value, none);
    uint64_t* out = bits + row * words;
    if (none) return void(std::fill(out, out + rows * words, 0));
    at_least(BitRows<T>{all + row * nx, nx, rows, least, out, words, wanted, otherwise});
  });
}

bool any_missing(const Array& samples, Context& context) {
  return native(samples, [&]<class T>(const T* p) {
    if constexpr (std::is_floating_point_v<T>)
      return parallel_reduce(
          samples.count(), 65536, false, [&](size_t begin, size_t end) { return any_nan(p + begin, end - begin); },
          [](bool a, bool b) { return a || b; }, &context);
    return false;
  });
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
