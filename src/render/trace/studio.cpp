// SPDX-License-Identifier: Apache-2.0
#include "render/trace/studio.h"

#include <cmath>

#include "render/shade/lamp.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

Studio studio_of(const Scene& scene, const Projection& projection) {
  constexpr float sky = 0.35f, across = 12;
  const float rise = 1 - std::cos(across / 2 * pi / 180);
  Studio studio;
  studio.environment = Environment(Vec3f{sky, sky, sky});
  for (const Lamp& lamp : lamps_of(lights_of(scene), projection)) {
    if (!(lamp.intensity > 0)) continue;
    const float e = lamp_irradiance * lamp.intensity;
    studio.lights.emplace_back(DistantLight{Vec3f(lamp.direction), {e, e, e}, rise});
  }
  return studio;
}

}  // namespace sg::trace
