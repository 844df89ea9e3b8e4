// SPDX-License-Identifier: Apache-2.0
// The textures of a picture: made once at one sample a pixel, looked up by pictures of the same view with more samples and by its bands.
#pragma once
#include <memory>
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

/// Multiplies the light of a shaded batch by the texture of item `number`. `projection`: of the picture that is shaded, of
/// 1 or more samples per pixel and side, whole or a band.
void apply_texture(const RenderTextures& textures, const PreparedItem& item, uint32_t number, const Projection& projection,
                   ShadeBatch& batch);

}  // namespace sg::raster
