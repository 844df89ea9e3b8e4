// SPDX-License-Identifier: Apache-2.0
// LitRay: the light of a picture as seen along one ray through a volume.
#pragma once
#include <vector>

#include "render/shade/lamp.h"
#include "scene/items/material.h"

namespace sg::volume {

struct LightEffects;

struct LitRay {
  std::vector<SeenLamp> lights;
  Vec3f direction;  ///< of the ray
  Material material;
  const LightEffects* effects = nullptr;  ///< of the volume; null = none, and what follows is not read
  Vec3 origin, along;                     ///< place at t = origin + t along
  Vec3f background;                       ///< linear, behind the ray
};

}  // namespace sg::volume
