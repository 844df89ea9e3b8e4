// SPDX-License-Identifier: Apache-2.0
// The colour of an item where a ray met it: from its fields, as the rasterizer colours them.
#pragma once
#include "render/prepare/picture_set.h"
#include "render/prepare/prepared.h"
#include "render/trace/integrators/ray_footprint.h"
#include "render/trace/tree/ray.h"

namespace sg::trace {

/// Linear RGB, straight alpha with the item's opacity. `scale`: traced length of a world length of 1. Pictures on the surface are filtered
/// over the footprint of the ray at the hit.
Vec4f surface_color(const raster::PreparedItem& item, const Ray& ray, const Hit& hit, const RayFootprint& footprint, double scale);

/// What one of its pictures shows there, linear and premultiplied with alpha; zeros where it has no place in the picture.
Vec4f surface_picture(const raster::PlacedPicture& picture, const raster::PreparedItem& item, const Ray& ray, const Hit& hit,
                      const RayFootprint& footprint, double scale);

/// Along what its highlights are stretched there, of any length.
Vec3f surface_direction(const raster::PictureSet& pictures, const raster::PreparedItem& item, const Hit& hit);

/// `normal`, unit, as its picture of normals bends it there.
Vec3f surface_normal(const raster::PreparedItem& item, const Ray& ray, const Hit& hit, const RayFootprint& footprint, double scale,
                     Vec3f normal);

}  // namespace sg::trace
