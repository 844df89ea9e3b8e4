// SPDX-License-Identifier: Apache-2.0
// Points of an item in the world, and the box around some of them. Internal.
#pragma once
#include <cmath>

#include "base/parallel.h"
#include "data/array.h"

namespace sg::trace {

/// Point i of packed f32 positions.
inline Vec3 world_point(const Array& xyz, Vec3 origin, size_t i) {
  const float* p = reinterpret_cast<const float*>(xyz.raw()) + 3 * i;
  return origin + Vec3(p[0], p[1], p[2]);
}

/// Of the points number(0), number(1), ... those that are finite.
template <class Number>
Box3 box_of(const Array& xyz, Vec3 origin, size_t count, Number&& number) {
  return parallel_reduce(
      count, size_t(1) << 14, Box3{},
      [&](size_t begin, size_t end) {
        Box3 b;
        for (size_t i = begin; i < end; ++i) {
          const Vec3 p = world_point(xyz, origin, number(i));
          if (std::isfinite(dot(p, p))) b.add(p);
        }
        return b;
      },
      [](Box3 a, const Box3& b) {
        a.add(b);
        return a;
      });
}

inline Box3 grown(Box3 b, double by) {
  if (!b.empty()) b.lo -= Vec3(by, by, by), b.hi += Vec3(by, by, by);
  return b;
}

}  // namespace sg::trace
