// SPDX-License-Identifier: Apache-2.0
#include "render/volume/engines/packets/scattered_light.h"

namespace sg::volume {

ScatteredLight::ScatteredLight(const LightEffects& effects, const std::vector<Lamp>& lamps, const Volume& volume)
    : phase(*effects.scatters), glow(effects.glow) {
  const Mat3 to_world = inverse(volume.to_q);
  for (size_t i = 0; i < lamps.size() && i < effects.lamps.size(); ++i) {
    const LightMap& map = *effects.lamps[i].volumes[0];
    Source s{map.samples(), {}, Vec3f(lamps[i].direction), effects.albedo * lamps[i].irradiance};
    for (int a = 0; a < 3; ++a) {
      const double first = map.coordinate(a, volume.origin);
      for (int k = 0; k < 3; ++k) {
        Vec3 one;
        one[k] = 1;
        s.from_q[a][k] = float(map.coordinate(a, volume.origin + to_world * one) - first);
      }
      s.from_q[a][3] = float(first);
    }
    sources.push_back(s);
  }
}

}  // namespace sg::volume
