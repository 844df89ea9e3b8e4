// SPDX-License-Identifier: Apache-2.0
#include "render/shade/blinn_phong.h"

namespace sg {

void light_point(const Material& m, std::span<const Lamp> lamps, Vec3f n, Vec3f to_viewer, float& light, float& gloss) {
  light = 1, gloss = 0;
  if (!m.lit) return;
  Reflected sum;
  for (const Lamp& lamp : lamps) {
    const SeenLamp l = seen_along(lamp, Vec3(-to_viewer));
    sum.add(l, dot(n, l.light), dot(n, l.half), m.power);
  }
  light = m.ambient + m.diffuse * sum.diffuse, gloss = m.specular * sum.specular;
}

}  // namespace sg
