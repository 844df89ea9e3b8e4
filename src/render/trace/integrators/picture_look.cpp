// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/picture_look.h"

#include <algorithm>
#include <cmath>

#include "render/prepare/edge_fade.h"

namespace sg::trace {

PictureLook::PictureLook(const PreparedScene& scene, const Projection& projection, double pixel,
                         std::shared_ptr<const RenderTextures> textures)
    : projection_(projection), pixel_(pixel), textures_(std::move(textures)) {
  for (const raster::PreparedItem& item : scene.items)
    edges_.push_back(item.segments && !item.segments->room.empty() ? raster::fade_together(item, pixel_) : 0);
}

void PictureLook::apply(const raster::PreparedItem& item, size_t number, uint32_t primitive, Vec3 place, Vec4f& color) const {
  if (fades(number)) color.w *= float(edges_[number] * raster::edge_fade(double(item.segments->room[primitive]) / pixel_));
  if (!textured(number)) return;
  const Vec3 at = projection_.to_pixel(place);
  if (!(at.z > 0 || projection_.parallel) || !(at.x >= 0 && at.x < projection_.width && at.y >= 0 && at.y < projection_.height)) return;
  const auto found = raster::texture_factor(*textures_, item, uint32_t(number), projection_, int(at.x), int(at.y), float(at.z));
  if (!found) return;
  // No surface sends back more than arrives.
  const float factor = std::min(*found, std::max(1.f, 1 / std::max({color.x, color.y, color.z, 1e-6f})));
  color.x *= factor, color.y *= factor, color.z *= factor;
}

}  // namespace sg::trace
