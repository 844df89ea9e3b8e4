// SPDX-License-Identifier: Apache-2.0
#include "io/volume/raw_guess.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "io/text/text_scan.h"

namespace sg {

namespace {

/// "name_50x40x30.bov" -> 50 40 30: the last such triple of the name.
bool size_in_name(const std::string& name, std::array<size_t, 3>& size) {
  bool found = false;
  for (size_t i = 0; i < name.size(); ++i) {
    if (!is_digit(name[i]) || (i > 0 && is_digit(name[i - 1]))) continue;
    const char *p = name.data() + i, *end = name.data() + name.size();
    std::array<int64_t, 3> v{};
    bool good = true;
    for (size_t a = 0; a < 3 && good; ++a) {
      good = p < end && is_digit(*p) && scan_number(p, end, v[a]) && v[a] > 0 && v[a] < 1000000;
      if (a < 2) good = good && p < end && (*p == 'x' || *p == 'X') && (++p, true);
    }
    if (good) size = {size_t(v[0]), size_t(v[1]), size_t(v[2])}, found = true;
  }
  return found;
}

// Mean difference of neighbours: small in the right byte order.
double roughness(const MappedFile& f, bool big_endian) {
  const size_t n = f.size() / 2, step = std::max<size_t>(n / 4096, 1);
  double sum = 0;
  for (size_t i = 0; i + 1 < n; i += step)
    sum += std::fabs(double(load<int16_t>(f.data() + 2 * i, big_endian)) - double(load<int16_t>(f.data() + 2 * i + 2, big_endian)));
  return sum;
}

// The share of numbers that look like measurements rather than like swapped bytes.
double usual_share(const MappedFile& f, bool big_endian) {
  const size_t n = f.size() / 4, step = std::max<size_t>(n / 4096, 1);
  size_t good = 0, seen = 0;
  for (size_t i = 0; i < n; i += step, ++seen) {
    const float v = std::fabs(load<float>(f.data() + 4 * i, big_endian));
    good += size_t(v == 0 || (v > 1e-12f && v < 1e12f));
  }
  return seen ? double(good) / double(seen) : 0;
}

}  // namespace

std::string RawGuess::text() const {
  return fmt::format("{}x{}x{} {}{}", dims[0], dims[1], dims[2], element_name(type),
                     type == ElementType::u8 ? ""
                     : big_endian            ? ", big-endian"
                                             : ", little-endian");
}

std::optional<RawGuess> guess_raw(const MappedFile& file) {
  RawGuess g;
  uint64_t count = 0;
  if (!size_in_name(file_name_of(file.path()), g.dims)) return {};
  if (!multiply(uint64_t(g.dims[0]), uint64_t(g.dims[1]), count) || !multiply(count, uint64_t(g.dims[2]), count)) return {};
  const uint64_t bytes = file.size() / count;
  if (bytes * count != file.size()) return {};
  switch (bytes) {
    case 1: return g;
    case 2:
      g.type = ElementType::i16;
      g.big_endian = roughness(file, true) < roughness(file, false);
      return g;
    case 4:
      g.type = ElementType::f32;
      g.big_endian = usual_share(file, true) > usual_share(file, false);
      return g;
    case 8: g.type = ElementType::f64; return g;
    default: return {};
  }
}

}  // namespace sg
