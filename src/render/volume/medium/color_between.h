// SPDX-License-Identifier: Apache-2.0
// Colours of a medium between the nodes of its table: what is practically opaque shows the colour of a single value, and the nearest node
// may be off by 1/1000.
#pragma once
#include "render/volume/medium/medium.h"

namespace sg::volume {

/// On a line of the medium, its ends included.
inline Vec3f color_between(const Medium& medium, int line, float v) {
  double at = (double(medium.axis(v)) - double(medium.first_node())) * double(medium.per_node()), first = 0, count = Medium::nodes;
  if (medium.pieced()) {
    const Medium::ColorPiece& p = medium.pieces()[line];
    at = (double(medium.axis(v)) - double(p.lo)) * double(p.per), first = double(p.first), count = double(p.count);
  }
  at = at >= 0 ? std::min(at, count) : 0;
  const double node = std::floor(at);
  const uint16_t *a = medium.colors() + 4 * size_t(first + node), *b = medium.colors() + 4 * size_t(first + std::min(node + 1, count));
  const auto mix = [&](int k) { return float((double(a[k]) + (at - node) * (double(b[k]) - double(a[k]))) / 65535); };
  return {mix(0), mix(1), mix(2)};
}

}  // namespace sg::volume
