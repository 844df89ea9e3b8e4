// SPDX-License-Identifier: Apache-2.0
// What the pictures of a surface show where a ray meets a triangle of it: one code for the rasterizer and for paths of light.
#pragma once
#include "render/prepare/picture_set.h"

namespace sg::raster {

/// A place on a triangle, and how it moves from a pixel to the next ones. All vectors in the units of the triangles' positions.
struct PictureRay {
  Vec3 direction;    ///< of the ray, any length
  Vec3 right, down;  ///< from where the ray meets the surface to where the next pixels' rays pass by it; zero: of no size
  double weights[3]{1, 0, 0};
  double per_pixel = 1;  ///< footprints like this one per pixel of the finished picture and side, for the width of lines
};

/// The footprint of the ray's pixel in a picture: perspective-correct, from the differentials of the ray (Igehy 1999).
TexturePlace place_in(const PlacedPicture& picture, const TriangleSet& triangles, size_t triangle, const PictureRay& ray);

/// What tint, picture and alpha make of the surface's own colour `rgba`, linear with straight alpha, at a place of the picture of colours
/// (of none: any).
Vec4f under_picture(const PictureSet& pictures, const TexturePlace& place, Vec4f rgba);

/// The same on a triangle, with the lines of equal value.
Vec4f picture_color(const PictureSet& pictures, const TriangleSet& triangles, size_t triangle, const PictureRay& ray, Vec4f rgba);

}  // namespace sg::raster
