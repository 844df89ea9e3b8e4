// SPDX-License-Identifier: Apache-2.0
#include "render/raster/lic/textures.h"

#include <cmath>

#include "filter/flow/texture/brightness.h"
#include "render/prepare/prepared.h"
#include "render/shade/shade.h"

namespace sg::raster {

namespace {

/// Light of a brightness 0 to 1: 1 at the middle; less above than below it, where colours would burn out.
float light_factor(float brightness, float strength) {
  const float t = 2 * brightness - 1;
  return 1 + strength * t * (t < 0 ? 1.0f : 0.5f);
}

}  // namespace

void apply_texture(const RenderTextures& textures, const PreparedItem& item, uint32_t number, const Projection& projection,
                   ShadeBatch& batch) {
  const LicPlanes& p = textures.layers[size_t(textures.layer_of[number])];
  const int rows = projection.rows > 0 ? projection.rows : projection.height;
  const double across = double(textures.width) / projection.width, down = double(textures.height) / rows;
  // A band's first row in the whole picture.
  const double first = projection.rows > 0 ? 0.5 * rows - projection.middle_y() : 0.0;
  const float contrast = float(item.lic->contrast), strength = float(item.lic->strength);
  const float reach = float(8 / (projection.scale * across));  // times depth in perspective: eight of the texture's pixels
  const auto off = [&](size_t i, float z) {
    const float there = projection.parallel ? p.w[i] : 1 / p.w[i];
    return std::abs(there - z);
  };
  for (size_t k = 0; k < batch.n; ++k) {
    const int x = std::min(int((batch.tile_x + int(batch.pixel[k] % tile_size) + 0.5) * across), p.width - 1);
    const int y = std::clamp(int((batch.tile_y + int(batch.pixel[k] / tile_size) + 0.5 + first) * down), 0, p.height - 1);
    const float z = batch.depth[k], allowed = projection.parallel ? reach : reach * z;
    size_t best = p.at(x, y);
    if (p.item[best] != number + 1 || !(off(best, z) <= allowed)) {
      // The pixel's own sample shows something else: the neighbour at about this depth, or nothing.
      float least = allowed;
      best = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const size_t i = p.at(x + dx, y + dy);
          if (p.item[i] == number + 1 && off(i, z) < least) least = off(i, z), best = i;
        }
      if (best == 0) continue;
    }
    if ((p.word[best] & ~0xFFu) == 0) continue;  // no direction: the plain colour
    float factor = light_factor(normal_brightness(contrast * p.value[best]), strength);
    const float brightest = std::max({batch.rgba[0][k], batch.rgba[1][k], batch.rgba[2][k]}) * batch.light[k];
    if (factor > 1 && brightest * factor > 1) factor = std::max(1.0f, 1 / brightest);  // keeps the hue
    batch.light[k] *= factor;
  }
}

}  // namespace sg::raster
