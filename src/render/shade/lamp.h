// SPDX-License-Identifier: Apache-2.0
// The lights of a scene in world space, and as seen along a ray.
#pragma once
#include <vector>

#include "base/vec.h"
#include "scene/camera.h"
#include "scene/scene.h"

namespace sg {

struct Lamp {
  Vec3 direction;  ///< towards the light: world, unit
  float intensity;
  float irradiance;  ///< of a surface that faces it
};
/// The lights of a picture: those that follow the camera are turned with it.
std::vector<Lamp> lamps_of(const std::vector<Light>& lights, const Projection& projection);

/// A lamp and the half vector (halfway between it and the viewer) for one direction of sight.
struct SeenLamp {
  Vec3f light, half;  ///< unit
  float intensity, irradiance;
};
/// `sight`: from the viewer on, unit.
inline SeenLamp seen_along(const Lamp& lamp, Vec3 sight) {
  return {Vec3f(lamp.direction), Vec3f(normalize(lamp.direction - sight)), lamp.intensity, lamp.irradiance};
}
/// All lamps; `out` keeps its memory.
inline void seen_along(const std::vector<Lamp>& lamps, Vec3 sight, std::vector<SeenLamp>& out) {
  out.clear();
  for (const Lamp& lamp : lamps) out.push_back(seen_along(lamp, sight));
}

}  // namespace sg
