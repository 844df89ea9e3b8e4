// SPDX-License-Identifier: Apache-2.0
// SurfacePoint: where a ray met a surface, how exactly that is known, and how to leave it again.
#pragma once
#include <cstdint>

#include "base/vec.h"

namespace sg::trace {

struct SurfacePoint {
  Vec3f position;        ///< traced coordinates
  Vec3f error;           ///< the surface lies within that of the position, along each axis
  Vec3f face_normal;     ///< unit; of the outer side, whichever the ray met: of closed surfaces the one out of the body, else by winding
  Vec3f shading_normal;  ///< unit, on the side of face_normal
  Vec3f tangent;         ///< unit, across shading_normal: along a triangle's first edge, a tube's axis; anywhere on balls and discs
  uint32_t object = 0, primitive = 0;
  float u = 0, v = 0;  ///< as in Hit
};

/// Where a ray into this direction starts: on its side of the surface, by no more than what the position may be wrong (a few units in the
/// last place), so that it does not meet the surface it leaves and misses nothing beside it. No constant to choose: the idea is that of
/// Pharr, Jakob, Humphreys, Physically Based Rendering, 6.8.6; here the tests themselves are exact near a ray's start, so that the
/// position's own rounding is all there is to step over.
Vec3f leave(const SurfacePoint& point, Vec3f direction);

/// A unit vector along `along` made perpendicular to the unit normal; any such where there is none.
Vec3f tangent_of(Vec3f normal, Vec3f along);

/// f32 rounds numbers by up to this share of them.
constexpr double half_unit = 0x1p-24;

/// The f32 numbers next to a place in double, and how far off they and `more` roundings of that size may be.
struct Rounded {
  Vec3f position, error;
};
Rounded rounded(Vec3 place, Vec3 more);

}  // namespace sg::trace
