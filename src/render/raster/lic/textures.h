// SPDX-License-Identifier: Apache-2.0
// The textures of a picture: made once at one sample a pixel, looked up by pictures of the same view with more samples and by its bands.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "render/raster/lic/surface_lic.h"
#include "scene/camera.h"

namespace sg {

struct RenderTextures {
  int width = 0, height = 0;              ///< of the whole picture
  std::vector<raster::LicPlanes> layers;  ///< [0] everything opaque, then one per translucent item
  std::vector<int> layer_of;              ///< per prepared item; -1: not textured
};

}  // namespace sg

namespace sg::raster {

struct ShadeBatch;
struct PreparedItem;

/// The factor that the texture of item `number` has for its light where it is seen at (x, y), pixels of the texture, at `depth`; nothing
/// where it has no direction or something else is seen there. `projection`: of the texture or of any other size of the same picture.
std::optional<float> texture_factor(const RenderTextures& textures, const PreparedItem& item, uint32_t number, const Projection& projection,
                                    int x, int y, float depth);

/// Multiplies the light of a shaded batch by the texture of item `number`. `projection`: of the picture that is shaded, of
/// 1 or more samples per pixel and side, whole or a band.
void apply_texture(const RenderTextures& textures, const PreparedItem& item, uint32_t number, const Projection& projection,
                   ShadeBatch& batch);

}  // namespace sg::raster
