// SPDX-License-Identifier: Apache-2.0
// PictureCamera: rays through pixels, and the way back: where in the picture a point is seen, and with which importance.
#pragma once
#include <optional>

#include "render/trace/integrators/pixel_box.h"
#include "render/trace/integrators/ray_footprint.h"
#include "render/trace/tree/ray.h"
#include "scene/camera.h"

namespace sg::trace {

/// How a point is seen.
struct Sight {
  Vec2f pixel;
  Vec3f direction;   ///< from the point to the eye, unit
  float distance;    ///< along it to where rays of the camera start, in front of which nothing is seen
  float importance;  ///< pixels per area across the ray at the point, traced: the measurement of a pixel is the integral of
                     ///< radiance * |cos| * importance over the surfaces that it sees
};

/// A pinhole, a parallel projection or a thin lens, of which each place is a pinhole by itself. Rays begin where they enter a ball about
/// the scene, so that they lose no digits on the way there.
class PictureCamera {
 public:
  PictureCamera(const Projection& projection, const Placement& placement);

  double pixels() const { return double(projection_.width) * double(projection_.height); }
  int width() const { return projection_.width; }
  int height() const { return projection_.height; }
  bool has_lens() const { return projection_.lens > 0; }
  /// `on_lens`: a place in the unit disc, from which the ray leaves towards what is sharp.
  Ray ray(Vec2f pixel, Vec2f on_lens = {}) const;
  /// Of such a ray: its part of the pixel, through the pinhole in the lens's middle.
  RayFootprint footprint(Vec2f pixel) const;
  /// Of a place along such a ray, t in traced coordinates: the distance along the viewing axis in the world.
  double depth(Vec2f pixel, float t) const;
  /// All pixels in which something of a box in traced coordinates may be seen.
  PixelBox pixels_of(const Box3f& box) const;
  /// By light through a place on the lens. Nothing for points beside the picture, behind the eye or nearer than the near plane. O(1).
  std::optional<Sight> sees(Vec3f point, Vec2f on_lens = {}) const;
  /// As of Sight, of a point that is seen.
  double importance(Vec3f point, Vec2f on_lens = {}) const;

 private:
  Projection::Ray inner_ray(Vec2f pixel, Vec2f on_lens) const;
  Vec3 off_middle(Vec2f on_lens) const;
  double start(const Projection::Ray& ray) const;

  Projection projection_;
  Placement placement_;
};

}  // namespace sg::trace
