// SPDX-License-Identifier: Apache-2.0
#include "image/enlarge.h"

#include <algorithm>

#include "base/parallel.h"

namespace sg {

namespace {

// The two samples that a pixel lies between, and the share of the second one.
struct Between {
  int first, second;
  uint16_t share;  // of 256
};
std::vector<Between> places(int count, int of) {
  std::vector<Between> all;
  all.reserve(size_t(count));
  for (int i = 0; i < count; ++i) {
    const double at = std::clamp((i + 0.5) * of / count - 0.5, 0.0, double(of - 1));
    const int first = int(at);
    all.push_back({first, std::min(first + 1, of - 1), uint16_t((at - first) * 256)});
  }
  return all;
}

void widen(const uint8_t* row, size_t channels, const std::vector<Between>& columns, uint8_t* to) {
  for (const Between& c : columns) {
    const uint8_t* left = row + channels * size_t(c.first);
    const uint8_t* right = row + channels * size_t(c.second);
    for (size_t k = 0; k < channels; ++k) *to++ = uint8_t((left[k] * (256 - c.share) + right[k] * c.share + 128) >> 8);
  }
}

}  // namespace

void paste_enlarged(const Image& part, int x, int y, int width, int height, Image& whole) {
  const size_t channels = size_t(part.channels), bytes = channels * size_t(width);
  const std::vector<Between> columns = places(width, part.width), rows = places(height, part.height);
  // Rows of `part` as wide as they will be, each once.
  std::vector<uint8_t> wide(bytes * size_t(part.height));
  parallel_for(size_t(part.height), 16, [&](size_t begin, size_t end) {
    for (size_t j = begin; j < end; ++j) widen(part.at(0, int(j)), channels, columns, &wide[bytes * j]);
  });
  parallel_for(size_t(height), 32, [&](size_t begin, size_t end) {
    for (size_t j = begin; j < end; ++j) {
      const uint8_t* above = &wide[bytes * size_t(rows[j].first)];
      const uint8_t* below = &wide[bytes * size_t(rows[j].second)];
      const uint16_t share = rows[j].share, rest = uint16_t(256 - share);
      uint8_t* to = whole.at(x, y + int(j));
      for (size_t i = 0; i < bytes; ++i) to[i] = uint8_t(uint16_t(above[i] * rest + below[i] * share + 128) >> 8);
    }
  });
}

}  // namespace sg
