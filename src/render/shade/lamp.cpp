// SPDX-License-Identifier: Apache-2.0
#include "render/shade/lamp.h"

#include <numbers>

namespace sg {

std::vector<Lamp> lamps_of(const std::vector<Light>& lights, const Projection& p) {
  constexpr float lit_share = 0.75f * std::numbers::pi_v<float>;
  std::vector<Lamp> lamps;
  for (const Light& l : lights) {
    const Vec3 d = l.follows_camera ? p.right * l.direction.x + p.up * l.direction.y - p.forward * l.direction.z : l.direction;
    lamps.push_back({normalize(d), l.intensity, l.irradiance.value_or(lit_share * l.intensity)});
  }
  return lamps;
}

}  // namespace sg
