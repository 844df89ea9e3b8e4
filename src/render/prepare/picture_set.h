// SPDX-License-Identifier: Apache-2.0
// PictureSet: the pictures of a surface with the coordinates of its points in them.
#pragma once
#include "render/prepare/prepared.h"
#include "scene/items/surface_pictures.h"

namespace sg::raster {

struct PlacedPicture {
  std::shared_ptr<const Texture> texture;
  TextureLookup lookup;
  Array coordinates;  ///< f32 x 2, packed: per point its place in the picture, (0, 0) to (1, 1)

  const float* uv() const { return reinterpret_cast<const float*>(coordinates.raw()); }
};

struct PlacedFactors {
  PlacedPicture picture;
  std::vector<FactorChannel> channels;
};

struct IsolineSet {
  Array values;               ///< f32, packed: per point, less `offset`
  std::vector<float> levels;  ///< rising, less `offset`
  float width = 1;            ///< pixels
  Vec3f color;                ///< linear

  const float* data() const { return reinterpret_cast<const float*>(values.raw()); }
};

struct PictureSet {
  Vec3f tint{1, 1, 1};
  std::optional<PlacedPicture> color, emission, normal, occlusion;
  float normal_scale = 1, occlusion_strength = 1;
  std::vector<PlacedFactors> factors;
  std::optional<IsolineSet> isolines;
  Array stretched_along;  ///< f32 x 3, packed: per point the direction in which highlights are stretched; none: empty
  SurfacePictures::Alpha alpha = SurfacePictures::Alpha::none;
  float cutoff = 0.5f;

  /// Whether something may be seen through the surface.
  bool translucent() const { return alpha != SurfacePictures::Alpha::none && color && color->texture->translucent(); }
};

/// Throws Error(usage) where the data has no such coordinates or values.
std::shared_ptr<const PictureSet> place_pictures(const SurfacePictures& pictures, const DatasetPtr& data);

}  // namespace sg::raster
