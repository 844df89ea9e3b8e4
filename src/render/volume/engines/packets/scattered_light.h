// SPDX-License-Identifier: Apache-2.0
// ScatteredLight: light that is scattered once (light=map), as packets read it.
#pragma once
#include <vector>

#include "render/volume/effects/effects.h"
#include "render/volume/engines/packets/packets.h"

namespace sg::volume {

/// What the colours of a place are multiplied by: glow, and of each lamp its strength, the phase function and its map.
struct ScatteredLight {
  struct Source {
    LightMap::Samples map;
    float from_q[3][4];  ///< where a place in q is in the map: (x, y, z, 1) times each row
    Vec3f towards;       ///< the lamp
    float strength;      ///< of its light, before the phase function
  };
  std::vector<Source> sources;  ///< at most Illumination::most_lamps
  PhaseFunction phase;
  float glow = 0;

  ScatteredLight(const LightEffects& effects, const std::vector<Lamp>& lamps, const Volume& volume);
};

}  // namespace sg::volume
