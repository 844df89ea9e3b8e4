// SPDX-License-Identifier: Apache-2.0
#include "scene/scene.h"

namespace sg {

Box3 scene_bounds(const Scene& scene) {
  Box3 box;
  for (const Item& item : scene.items)
    std::visit(
        [&](const auto& i) {
          if (i.data) box.add(i.data->bounds());
        },
        item);
  return box;
}

std::vector<Light> lights_of(const Scene& scene) {
  if (!scene.lights.empty()) return scene.lights;
  return {{{-0.35, 0.45, 1.0}, true, 0.85f}, {{0.9, 0.1, 0.5}, true, 0.22f}};
}

}  // namespace sg
