// SPDX-License-Identifier: Apache-2.0
#include "render/shade/lamp.h"

namespace sg {

std::vector<Lamp> lamps_of(const std::vector<Light>& lights, const Projection& p) {
  std::vector<Lamp> lamps;
  for (const Light& l : lights) {
    const Vec3 d = l.follows_camera ? p.right * l.direction.x + p.up * l.direction.y - p.forward * l.direction.z : l.direction;
    lamps.push_back({normalize(d), l.intensity});
  }
  return lamps;
}

}  // namespace sg
