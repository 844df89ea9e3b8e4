// SPDX-License-Identifier: Apache-2.0
#include "io/scan/dicom_stored.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/scan/dicom_encoder.h"
#include "io/write_losses.h"

namespace sg {

namespace {

constexpr double steps_of_16_bits = 65535, most_exact_intercept = 1e14;

bool all_whole(const Array& a) {
  if (!is_float(a.type())) return true;
  return dispatch(a, [&](const auto& v) {
    return parallel_reduce(
        v.count, 1 << 16, true,
        [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i)
            if (const auto x = double(v(i, 0)); std::isfinite(x) && x != std::floor(x)) return false;
          return true;
        },
        [](bool x, bool y) { return x && y; });
  });
}

double as_written(double v) { return parse_double(decimal_string(v)).value_or(v); }

// The first decimal at or above (below) a number.
double written_beyond(double v, int way) {
  double w = as_written(v), by = std::max(std::abs(v) * 1e-15, 1e-300);
  for (; way * (w - v) < 0; by *= 2) w = as_written(v + way * by);
  return w;
}

Array quantized(const Array& a, double slope, double intercept, const Range& range) {
  uint16_t* out = nullptr;
  Array r = Array::make<uint16_t>(a.count(), 1, &out);
  dispatch(a, [&](const auto& v) {
    parallel_for(v.count, 1 << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const auto x = double(v(i, 0));
        const double in_range = std::isnan(x) ? range.lo : std::clamp(x, range.lo, range.hi);
        out[i] = uint16_t(std::clamp(std::nearbyint((in_range - intercept) / slope), 0.0, steps_of_16_bits));
      }
    });
  });
  return r;
}

}  // namespace

DicomStored dicom_stored(const Array& values) {
  const FieldStats stats = field_stats(values);
  DicomStored s;
  s.missing = stats.nan + stats.infinite;
  Range range = stats.range[0];
  if (range.empty()) range = {0, 0};
  if (!std::isfinite(range.hi - range.lo))
    fail_usage(fmt::format("values from {} to {} are too far apart for DICOM", range.lo, range.hi), "", "write .nrrd");
  const bool whole = all_whole(values), narrow = range.hi - range.lo <= steps_of_16_bits;
  if (whole && narrow && std::abs(range.lo) <= most_exact_intercept) {
    s.intercept = range.lo >= 0 && range.hi <= steps_of_16_bits ? 0 : range.lo;
    constexpr int fewest_bits = 9;  // of the words that the format's class allows
    s.bits = std::max(fewest_bits, int(std::bit_width(uint32_t(range.hi - s.intercept))));
    s.numbers = quantized(values, 1, s.intercept, range);
  } else {
    s.intercept = written_beyond(range.lo, -1);
    const double slope = (range.hi - s.intercept) / steps_of_16_bits;
    s.slope = slope > 1e-290 ? written_beyond(slope, 1) : 1;
    s.exact = range.lo == range.hi && s.intercept == range.lo && survives(values, ElementType::f32);
    s.numbers = quantized(values, s.slope, s.intercept, range);
  }
  return s;
}

}  // namespace sg
