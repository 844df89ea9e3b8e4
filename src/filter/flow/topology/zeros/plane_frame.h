// SPDX-License-Identifier: Apache-2.0
// The plane in which a mesh lies, if it does.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "data/dataset.h"

namespace sg {

/// Right-handed unit vectors: e1 along the surface and nearest to x (y where x is the normal), e2, normal. The normal's largest
/// component is positive, so that a mesh in the xy plane has e1 = x and e2 = y.
struct PlaneFrame {
  Vec3 origin, e1{1, 0, 0}, e2{0, 1, 0}, normal{0, 0, 1};
  Vec2 project(Vec3 v) const { return {dot(v, e1), dot(v, e2)}; }
  Vec2 place(Vec3 x) const { return project(x - origin); }
  Vec3 at(Vec2 p) const { return origin + p.x * e1 + p.y * e2; }
};

/// Nothing when a point is further than 1e-5 of the mesh's size from the plane. For points on one line: any plane through it.
std::optional<PlaneFrame> plane_of(const Dataset& data);
/// That of all of them together.
std::optional<PlaneFrame> plane_of(std::span<const Dataset* const> parts);

}  // namespace sg
