// SPDX-License-Identifier: Apache-2.0
// PictureLook: what of the colours of items depends on the picture that is made of them. Edges of cells fade where they would be as close
// as pixels; textures of flow (LIC) are drawn at the picture's resolution, and seen wherever a path comes to a place that the picture
// shows.
#pragma once
#include <memory>
#include <vector>

#include "render/prepare/prepared.h"
#include "render/raster/lic/textures.h"
#include "scene/camera.h"

namespace sg::trace {

class PictureLook {
 public:
  PictureLook() = default;
  /// `pixel`: world length of one at the scene's distance. `textures`: of the whole picture; null where no item has any.
  PictureLook(const PreparedScene& scene, const Projection& projection, double pixel, std::shared_ptr<const RenderTextures> textures);

  /// Whether apply() changes colours of the item.
  bool changes(size_t item) const { return fades(item) || textured(item); }
  /// Whether it makes them translucent.
  bool fades(size_t item) const { return item < edges_.size() && edges_[item] > 0; }
  /// `color`: linear, straight alpha; of a primitive of the item, at a place in the world.
  void apply(const raster::PreparedItem& item, size_t number, uint32_t primitive, Vec3 place, Vec4f& color) const;

 private:
  bool textured(size_t item) const { return textures_ && textures_->layer_of[item] >= 0; }
  Projection projection_;
  double pixel_ = 1;
  std::shared_ptr<const RenderTextures> textures_;
  std::vector<double> edges_;  // of each item what is left of all its edges; 0: it has none
};

}  // namespace sg::trace
