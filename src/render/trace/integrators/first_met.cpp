// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/first_met.h"

#include <optional>

namespace sg::trace {

void see_first_met(const World& world, const PictureCamera& camera, MediaWalk* media, size_t pixel, Frame& frame) {
  const auto width = size_t(frame.width);
  const Vec2f middle{float(pixel % width) + 0.5f, float(pixel / width) + 0.5f};
  const Ray ray = camera.ray(middle);
  Hit hit;
  if (world.geometry().nearest(ray, hit)) frame.ids[pixel] = world.id(hit);
  if (media) {
    RandomStream random(pixel);
    const float passes = media->passes_exactly({ray.origin, ray.direction, hit.t});
    const auto matter = passes <= 0.5f ? media->collide_surely(0.5f / (1 - passes), random) : std::nullopt;
    if (matter) hit.t = matter->t, frame.ids[pixel] = matter->item + 1;
  }
  if (frame.ids[pixel] != 0) frame.depth[pixel] = float(camera.depth(middle, hit.t));
}

}  // namespace sg::trace
