// SPDX-License-Identifier: Apache-2.0
// A part of a linear solid cell: the image of an axis-parallel box of its reference element. Internal to src/data.
#pragma once
#include <array>

#include "base/vec.h"

namespace sg {

/// Positions at the corners of a box in [0,1]^3, collapsed onto the element; bit a of a corner's number is its side along axis a. In each
/// of these coordinates the map is linear, so the part lies in the convex hull of its corners, and their means are corners of its halves.
class MultilinearPart {
 public:
  std::array<Vec3, 8> corner;

  /// Whether x, `margin` extents of the part around it allowed for, is surely not in the part: it is beyond all corners across an axis of
  /// space, or across a side of the parallelepiped that the part is nearly, the smaller the nearer.
  bool excludes(Vec3 x, double margin) const;
  /// The eighths, in the order of the corners that they share with the part.
  void divide(std::array<MultilinearPart, 8>& eighths) const;
};

}  // namespace sg
