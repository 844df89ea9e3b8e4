// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/zeros/winding.h"

#include <cmath>

namespace sg {

std::optional<int> winding_index(std::span<const Vec2> loop) {
  double sum = 0;
  for (size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = loop[i], b = loop[(i + 1) % loop.size()];
    const double turn = a.x * b.y - a.y * b.x, along = a.x * b.x + a.y * b.y;
    if (turn == 0 && !(along > 0)) return std::nullopt;
    sum += std::atan2(turn, along);
  }
  return int(std::lround(sum / (2 * M_PI)));
}

std::optional<int> covering_index(std::span<const Vec3> v, std::span<const std::array<uint32_t, 3>> triangles) {
  double sum = 0;
  for (const auto& t : triangles) {
    const Vec3 a = v[t[0]], b = v[t[1]], c = v[t[2]];
    const double la = length(a), lb = length(b), lc = length(c);
    const double volume = dot(a, cross(b, c)), rest = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    if (!(la > 0 && lb > 0 && lc > 0) || (volume == 0 && rest < 0)) return std::nullopt;
    sum += 2 * std::atan2(volume, rest);
  }
  return int(std::lround(sum / (4 * M_PI)));
}

}  // namespace sg
