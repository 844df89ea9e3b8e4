// SPDX-License-Identifier: Apache-2.0
// SplatFilm: a picture to which any thread adds light anywhere. Sums are whole numbers of 2^-24, as these are the same in any order, which
// sums of floats are not: the same bytes for any number of threads, without lists of splats that would be larger than the picture.
#pragma once
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "base/vec.h"

namespace sg::trace {

class SplatFilm {
 public:
  SplatFilm(int width, int height)
      : width_(width), height_(height), sums_(std::make_unique<std::atomic<int64_t>[]>(3 * size_t(width) * size_t(height))) {}

  /// To the pixel in which a place of the picture lies. One splat counts for at most 2^24 times white; what is not finite for nothing.
  void add(Vec2f place, Vec3 light) {
    const auto x = std::clamp(int(place.x), 0, width_ - 1), y = std::clamp(int(place.y), 0, height_ - 1);
    const size_t at = 3 * (size_t(y) * size_t(width_) + size_t(x));
    for (size_t c = 0; c < 3; ++c) {
      const double v = light[int(c)];
      if (v > 0 && std::isfinite(v)) sums_[at + c].fetch_add(std::llround(std::min(v, 0x1p24) * 0x1p24), std::memory_order_relaxed);
    }
  }
  Vec3 sum(size_t pixel) const { return {value(3 * pixel), value(3 * pixel + 1), value(3 * pixel + 2)}; }
  void clear(size_t pixel) {
    for (size_t c = 0; c < 3; ++c) sums_[3 * pixel + c].store(0, std::memory_order_relaxed);
  }

 private:
  double value(size_t i) const { return double(sums_[i].load(std::memory_order_relaxed)) * 0x1p-24; }

  int width_, height_;
  std::unique_ptr<std::atomic<int64_t>[]> sums_;
};

}  // namespace sg::trace
