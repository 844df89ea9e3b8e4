// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/first_met.h"

#include <algorithm>
#include <optional>

namespace sg::trace {

void see_first_met(const World& world, const PictureCamera& camera, MediaWalk* media, const PixelBox& pixels, Frame& frame) {
  constexpr int most = Geometry::most_together;
  for (int p = 0; p < pixels.count(); p += most) {
    const int n = std::min(most, pixels.count() - p);
    Vec2f middle[most];
    Ray rays[most];
    Hit hits[most];
    for (int i = 0; i < n; ++i) {
      middle[i] = {float(pixels.column(p + i)) + 0.5f, float(pixels.row(p + i)) + 0.5f};
      rays[i] = camera.ray(middle[i]);
    }
    const uint64_t met = world.geometry().nearest(rays, n, hits);
    for (int i = 0; i < n; ++i) {
      const size_t pixel = size_t(pixels.row(p + i)) * size_t(frame.width) + size_t(pixels.column(p + i));
      Hit& hit = hits[i];
      if (met >> i & 1) frame.ids[pixel] = world.id(hit);
      if (media) {
        RandomStream random(pixel);
        const float passes = media->passes_exactly({rays[i].origin, rays[i].direction, hit.t});
        const auto matter = passes <= 0.5f ? media->collide_surely(0.5f / (1 - passes), random) : std::nullopt;
        if (matter) hit.t = matter->t, frame.ids[pixel] = matter->item + 1;
      }
      if (frame.ids[pixel] != 0) frame.depth[pixel] = float(camera.depth(middle[i], hit.t));
    }
  }
}

}  // namespace sg::trace
