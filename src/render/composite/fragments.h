// SPDX-License-Identifier: Apache-2.0
// Translucent fragments of a frame, per pixel from near to far: what volumes and surfaces are mixed by.
#pragma once
#include <cstdint>
#include <vector>

namespace sg {

struct Fragment {
  float depth;    ///< eye z
  float rgba[4];  ///< linear, premultiplied
  uint32_t id;    ///< item number + 1
};

/// Pixel p has fragments start[p] .. start[p+1], sorted by (depth, id, order of drawing). Empty vectors = none anywhere.
struct FragmentLists {
  std::vector<uint32_t> start;
  std::vector<Fragment> fragments;
  bool empty() const { return fragments.empty(); }
};

}  // namespace sg
