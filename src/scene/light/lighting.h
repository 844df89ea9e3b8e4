// SPDX-License-Identifier: Apache-2.0
// All that is stated of a picture's light, and where it stands about the data.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "base/vec.h"
#include "image/linear_picture.h"
#include "scene/light/environment_params.h"
#include "scene/light/light_params.h"

namespace sg {

struct Lighting {
  std::vector<LightParams> lights;
  std::optional<EnvironmentParams> environment;
  std::shared_ptr<const LinearPicture> picture;  ///< of PictureEnvironmentParams
  Vec3 up{0, 0, 1}, front{0, -1, 0};             ///< of the data; north lies opposite to the front

  bool stated() const { return !lights.empty() || environment; }
};

/// A light that has found its place. World coordinates, but for `way` where it follows the camera.
struct PlacedLight {
  enum class Shape { point, spot, directional, sphere, disc, rectangle, sun };
  Shape shape = Shape::directional;
  Vec3 way{0, 0, 1};  ///< from `about` to the light; of distant ones a unit vector; in eye space (as of Light) with follows_camera
  bool follows_camera = true;
  Vec3 about;             ///< place that it is placed from
  Vec3 target;            ///< place that discs and rectangles face
  Vec3f color{1, 1, 1};   ///< linear
  double brightness = 1;  ///< of a white surface at `about` that faces it: irradiance / pi
  double radiance = 1;    ///< of its surface, before its colour; of points and spots power per solid angle
  double radius = 0, width = 0, height = 0;
  double angle = 0;                ///< degrees across, of distant ones
  double inner = 0, outer = 0;     ///< of spots: degrees from the axis up to which it is at full strength, and at which it ends
  double elevation = 0, haze = 1;  ///< of the sun
  bool azimuth_follows = false;    ///< of the sun: it follows the camera about the vertical alone
};
/// `box`: of the data.
std::vector<PlacedLight> place_lights(const Lighting& lighting, const Box3& box);
/// The sun of a sky: that of the light 'sun', where the sky states no other.
PlacedLight place_sun(const Lighting& lighting, const SkyEnvironmentParams& sky);

/// Towards a light, unit: `way` turned with a camera of these axes (world, unit; forward is the line of sight).
Vec3 world_way(const PlacedLight& light, const Lighting& lighting, Vec3 right, Vec3 up, Vec3 forward);

}  // namespace sg
