// SPDX-License-Identifier: Apache-2.0
// The ways of a step's particles, many at a time: where they lie, and whether one leads beyond all numbers.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/vec.h"

namespace sg::swarm {

/// Of places before and after a step.
inline Box3 box_of_ways(std::span<const Vec3> from, std::span<const Vec3> to) {
  Box3 b;
  const auto less = [](double p, double q) { return p < q ? p : q; };
  const auto more = [](double p, double q) { return p > q ? p : q; };
  for (size_t i = 0; i < from.size(); ++i) {
    const Vec3 p = from[i], q = to[i];
    b.lo = {less(less(p.x, q.x), b.lo.x), less(less(p.y, q.y), b.lo.y), less(less(p.z, q.z), b.lo.z)};
    b.hi = {more(more(p.x, q.x), b.hi.x), more(more(p.y, q.y), b.hi.y), more(more(p.z, q.z), b.hi.z)};
  }
  return b;
}

/// Whether a number is NaN, infinite or beyond 2^1008, by its exponent: without branches, several at a time.
inline bool any_vast(std::span<const Vec3> values) {
  uint64_t high = 0;
  for (const Vec3& v : values)
    for (const double c : {v.x, v.y, v.z}) high |= (std::bit_cast<uint64_t>(c) & uint64_t(0x7ff) << 52) + (uint64_t(0x010) << 52);
  return high >> 63;
}

}  // namespace sg::swarm
