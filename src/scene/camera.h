// SPDX-License-Identifier: Apache-2.0
// Camera: right-handed, looks along target - position. Pixel (0,0) is the top left, pixel centres lie at +0.5.
#pragma once
#include <optional>
#include <string>

#include "base/vec.h"

namespace sg {

struct Camera {
  Vec3 position{0, 0, 1}, target{0, 0, 0}, up{0, 1, 0};
  double view_angle = 30;  ///< degrees, vertical; perspective only
  bool parallel = false;
  double parallel_height = 1;                  ///< world height of the picture; parallel only
  double near_plane = 0.01, far_plane = 1000;  ///< eye distances; depth beyond is clipped
  double lens = 0;                             ///< diameter of a thin lens, world; 0 = a pinhole: all is sharp
  double focus = 0;                            ///< with a lens: depth that is sharp

  Vec3 forward() const { return normalize(target - position); }
};

/// Everything needed to go from world to picture and back. Eye space: x right, y up, z along the view direction (positive
/// in front): "depth" everywhere is that z.
struct Projection {
  int width = 1, height = 1;
  bool parallel = false;
  Vec3 eye, right, up, forward;     ///< orthonormal, world
  double shift_x = 0, shift_y = 0;  ///< pixels added: a part of a picture is drawn with the projection of the whole, shifted
  double scale = 1;                 ///< pixels per unit of (x/z) in perspective, pixels per world unit in parallel
  double near_plane = 0.01, far_plane = 1000;
  int rows = 0;                ///< of the whole picture of which this is a part; 0 = height
  double lens = 0, focus = 0;  ///< as of Camera

  /// Where the view's axis meets the picture.
  double middle_x() const { return 0.5 * width + shift_x; }
  double middle_y() const { return 0.5 * height + shift_y; }

  Vec3 to_eye(Vec3 world) const {
    const Vec3 d = world - eye;
    return {dot(d, right), dot(d, up), dot(d, forward)};
  }
  /// Pixel coordinates (x right, y down) and depth; meaningless for depth <= 0 in perspective.
  Vec3 to_pixel(Vec3 world) const {
    const Vec3 e = to_eye(world);
    const double s = parallel ? scale : scale / e.z;
    return {middle_x() + s * e.x, middle_y() - s * e.y, e.z};
  }
  struct Ray {
    Vec3 origin, direction;  ///< direction has length 1
    double per_depth;        ///< ray length per unit of depth
  };
  Ray ray(double px, double py) const;
};
Projection make_projection(const Camera& camera, int width, int height);
/// The projection of rows [first, first + rows) of the picture as a picture of their own.
Projection band_of(const Projection& whole, int first, int rows);
/// The projection of the pixels [x, x + width) x [y, y + height) as a picture of their own, each of them as `finer` x `finer` pixels.
Projection window_of(const Projection& whole, int x, int y, int width, int height, int finer = 1);

/// Looks at the box from `direction` (towards the viewer; need not be unit) so that all of it is seen with `margin` of the
/// picture left free on each side; sets near and far. A flat or empty box works too.
Camera fit_camera(const Box3& box, Vec3 direction, Vec3 up, double aspect, double margin = 0.08, double view_angle = 30,
                  bool parallel = false);
/// Near and far planes around the box.
void fit_planes(Camera& camera, const Box3& box);

}  // namespace sg
