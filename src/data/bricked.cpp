// SPDX-License-Identifier: Apache-2.0
#include "data/bricked.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace sg {

namespace {

constexpr BrickedVolume::Extremes none{HUGE_VALF, -HUGE_VALF};

std::array<size_t, 3> blocks_of(const std::array<size_t, 3>& dims) {
  std::array<size_t, 3> n{};
  for (size_t a = 0; a < 3; ++a) n[a] = std::max<size_t>(1, (dims[a] - 1 + BrickedVolume::block - 1) / BrickedVolume::block);
  return n;
}

// Eight at a time: a single chain of comparisons would wait for each.
template <class T>
void widen(const T* row, size_t n, size_t stride, T& lo, T& hi) {
  if (stride == 1) {
    constexpr size_t lanes = 16;
    T l[lanes], h[lanes];
    std::fill_n(l, lanes, lo), std::fill_n(h, lanes, hi);
    size_t i = 0;
    for (; i + lanes <= n; i += lanes)
      for (size_t k = 0; k < lanes; ++k) {
        const T v = row[i + k];
        l[k] = v < l[k] ? v : l[k];
        h[k] = v > h[k] ? v : h[k];
      }
    for (size_t k = 0; k < lanes; ++k) lo = std::min(lo, l[k]), hi = std::max(hi, h[k]);
    row += i, n -= i;
  }
  for (size_t i = 0; i < n; ++i) {
    const T v = row[i * stride];
    if (v < lo) lo = v;
    if (v > hi) hi = v;
  }
}

float rounded_down(double v) {
  const float f = float(v);
  return double(f) > v ? std::nextafter(f, -HUGE_VALF) : f;
}
float rounded_up(double v) {
  const float f = float(v);
  return double(f) < v ? std::nextafter(f, HUGE_VALF) : f;
}

}  // namespace

std::array<size_t, 3> BrickedVolume::blocks() const { return blocks_of(levels[0].dims); }

Range BrickedVolume::range() const {
  Range r;
  for (const Extremes& e : extremes)
    if (e.lo <= e.hi) r.add({double(e.lo), double(e.hi)});
  return r;
}

uint64_t BrickedVolume::bytes() const { return uint64_t(levels[0].dims[0]) * levels[0].dims[1] * levels[0].dims[2] * element_size(type); }

Box3 BrickedVolume::bounds() const {
  Box3 box;
  const Level& l = levels[0];
  for (size_t c = 0; c < 8; ++c) {
    const Vec3 corner(double(c & 1 ? l.dims[0] - 1 : 0), double(c & 2 ? l.dims[1] - 1 : 0), double(c & 4 ? l.dims[2] - 1 : 0));
    box.add(l.origin + direction * (l.spacing * corner));
  }
  return box;
}

BlockExtremes::BlockExtremes(std::array<size_t, 3> dims) : dims_(dims), blocks_(blocks_of(dims)) {
  extremes_.assign(blocks_[0] * blocks_[1] * blocks_[2], none);
}

void BlockExtremes::add(const Array& slab, int component, size_t count) {
  const size_t nx = dims_[0], ny = dims_[1], first = next_;
  constexpr size_t edge = BrickedVolume::block;
  next_ += count;
  dispatch(slab, [&](auto view) {
    using T = std::remove_cv_t<std::remove_reference_t<decltype(view[0])>>;
    const auto step = size_t(view.components);
    parallel_for(blocks_[0] * blocks_[1], 1, [&](size_t begin, size_t end) {
      for (size_t column = begin; column < end; ++column) {
        const size_t x0 = column % blocks_[0] * edge, y0 = column / blocks_[0] * edge;
        const size_t x1 = std::min(x0 + edge, nx - 1), y1 = std::min(y0 + edge, ny - 1);
        for (size_t k = 0; k < count; ++k) {
          T lo = std::numeric_limits<T>::has_infinity ? std::numeric_limits<T>::infinity() : std::numeric_limits<T>::max();
          T hi = std::numeric_limits<T>::has_infinity ? -std::numeric_limits<T>::infinity() : std::numeric_limits<T>::lowest();
          for (size_t y = y0; y <= y1; ++y)
            widen(view.data + ((k * ny + y) * nx + x0) * step + size_t(component), x1 - x0 + 1, step, lo, hi);
          if (!(lo <= hi)) continue;
          const size_t z = first + k, own = std::min(z / edge, blocks_[2] - 1);
          auto widen_block = [&](size_t bz) {
            auto& e = extremes_[column + blocks_[0] * blocks_[1] * bz];
            e.lo = std::min(e.lo, rounded_down(double(lo))), e.hi = std::max(e.hi, rounded_up(double(hi)));
          };
          widen_block(own);
          if (z > 0 && z % edge == 0 && z / edge <= own) widen_block(z / edge - 1);  // the slice that two blocks share
        }
      }
    });
  });
}

}  // namespace sg
