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

std::optional<float> texture_factor(const RenderTextures& textures, const PreparedItem& item, uint32_t number, const Projection& projection,
                                    int x, int y, float z) {
  const LicPlanes& p = textures.layers[size_t(textures.layer_of[number])];
  // Eight of the texture's pixels.
  const auto reach = float(8 / (projection.scale * textures.width / projection.width));
  const float allowed = projection.parallel ? reach : reach * z;
  const auto off = [&](size_t i) {
    const float there = projection.parallel ? p.w[i] : 1 / p.w[i];
    return std::abs(there - z);
  };
  x = std::clamp(x, 0, p.width - 1), y = std::clamp(y, 0, p.height - 1);
  size_t best = p.at(x, y);
  if (p.item[best] != number + 1 || !(off(best) <= allowed)) {
    // The pixel's own sample shows something else: the neighbour at about this depth, or nothing.
    float least = allowed;
    best = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const size_t i = p.at(x + dx, y + dy);
        if (p.item[i] == number + 1 && off(i) < least) least = off(i), best = i;
      }
    if (best == 0) return {};
  }
  if ((p.word[best] & ~0xFFu) == 0) return {};  // no direction: the plain colour
  return light_factor(normal_brightness(float(item.lic->contrast) * p.value[best]), float(item.lic->strength));
}

void apply_texture(const RenderTextures& textures, const PreparedItem& item, uint32_t number, const Projection& projection,
                   ShadeBatch& batch) {
  const int rows = projection.rows > 0 ? projection.rows : projection.height;
  const double across = double(textures.width) / projection.width, down = double(textures.height) / rows;
  // A band's first row in the whole picture.
  const double first = projection.rows > 0 ? 0.5 * rows - projection.middle_y() : 0.0;
  for (size_t k = 0; k < batch.n; ++k) {
    const int x = int((batch.tile_x + int(batch.pixel[k] % tile_size) + 0.5) * across);
    const int y = int((batch.tile_y + int(batch.pixel[k] / tile_size) + 0.5 + first) * down);
    const auto found = texture_factor(textures, item, number, projection, x, y, batch.depth[k]);
    if (!found) continue;
    float factor = *found;
    const float brightest = std::max({batch.rgba[0][k], batch.rgba[1][k], batch.rgba[2][k]}) * batch.light[k];
    if (factor > 1 && brightest * factor > 1) factor = std::max(1.0f, 1 / brightest);  // keeps the hue
    batch.light[k] *= factor;
  }
}

}  // namespace sg::raster
