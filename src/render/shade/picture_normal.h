// SPDX-License-Identifier: Apache-2.0
// The normal of a surface on which a picture says how it is bent: one code for the rasterizer and for paths of light.
#pragma once
#include "render/shade/picture_color.h"

namespace sg::raster {

/// `normal` bent as the texel says that is seen there: with r, g, b in [0, 1],
///
///     n' = scale (2 r - 1) t + scale (2 g - 1) b + (2 b - 1) n
///
/// t along which the picture's x rises on the triangle, made perpendicular to n, b perpendicular to both, where its y rises
/// (glTF 2.0, 3.9.3, without tangents of its own). Unit, and on the triangle's side of `normal`, which is unit; that itself where the
/// triangle has no place in the picture.
Vec3 picture_normal(const PlacedPicture& picture, float scale, const TriangleSet& triangles, size_t triangle, const PictureRay& ray,
                    Vec3 normal);

}  // namespace sg::raster
