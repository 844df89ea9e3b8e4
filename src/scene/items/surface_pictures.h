// SPDX-License-Identifier: Apache-2.0
// Pictures on a surface: of its colour, and of what its material is.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/vec.h"
#include "data/fields/material_table.h"
#include "image/texture/lookup.h"

namespace sg {

struct SurfacePicture {
  std::shared_ptr<const Texture> texture;
  std::string coordinates;                        ///< point field: x and y, or x alone
  std::string second_coordinates;                 ///< one for y; without any, y is 0
  std::array<double, 6> place{1, 0, 0, 0, 1, 0};  ///< u = p0 x + p1 y + p2, v = p3 x + p4 y + p5
  TextureLookup lookup;
};

/// Numbers of the material that a picture multiplies; those of colours and lengths are all red, green and blue.
struct SurfaceFactors {
  SurfacePicture picture;
  std::vector<FactorChannel> channels;
};

/// Lines where a point field has certain values, drawn pixel by pixel.
struct SurfaceIsolines {
  std::string field;
  int component = -1;             ///< -1: the only one, or the magnitude
  std::vector<double> values;     ///< rising
  double width = 1.2;             ///< pixels
  Vec3f color{0.1f, 0.1f, 0.1f};  ///< sRGB
};

struct SurfacePictures {
  Vec3f tint{1, 1, 1};                  ///< linear; multiplied with the surface's colour
  std::optional<SurfacePicture> color;  ///< multiplied with the surface's colour, which shows alone where the picture holds none
  /// Its alpha: no, coverage, or a hole where it is below `cutoff`. Without, what a texture's alpha leaves open is filled with its colours.
  enum class Alpha { none, coverage, cutout } alpha = Alpha::none;
  float cutoff = 0.5f;
  std::vector<SurfaceFactors> factors;
  std::optional<SurfacePicture> emission;   ///< multiplied with that of the material
  std::optional<SurfacePicture> normal;     ///< directions: right, up and out of the surface as 0 to 1 for -1 to 1
  float normal_scale = 1;                   ///< of their share across the surface
  std::optional<SurfacePicture> occlusion;  ///< red: the share of even light that arrives, where light is not followed
  float occlusion_strength = 1;             ///< of what that takes away
  std::optional<SurfaceIsolines> isolines;  ///< over all of it
  std::string stretched_along;              ///< point field of vectors, along which highlights are stretched (specular_anisotropy)
};

}  // namespace sg
