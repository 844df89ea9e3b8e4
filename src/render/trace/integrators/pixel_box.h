// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

namespace sg::trace {

/// Pixels of a picture, numbered row by row; those of a square of 8 x 8 along a Z-curve, on which any 4 or 16 from a multiple of that on
/// are a square.
struct PixelBox {
  int x = 0, y = 0, w = 0, h = 0;

  int count() const { return w * h; }
  int column(int p) const { return x + (on_curve() ? every_other_bit(p) : p % w); }
  int row(int p) const { return y + (on_curve() ? every_other_bit(p >> 1) : p / w); }
  bool overlaps(const PixelBox& o) const {
    return std::max(x, o.x) < std::min(x + w, o.x + o.w) && std::max(y, o.y) < std::min(y + h, o.y + o.h);
  }

 private:
  bool on_curve() const { return w == 8 && h == 8; }
  static int every_other_bit(int p) { return (p & 1) | (p >> 1 & 2) | (p >> 2 & 4); }
};

}  // namespace sg::trace
