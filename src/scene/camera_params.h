// SPDX-License-Identifier: Apache-2.0
// The camera as a user states it: all parts optional, the rest is chosen from the data.
#pragma once
#include <optional>

#include "base/schema/schema.h"
#include "scene/camera.h"

namespace sg {

/// Named as an observer would: "front" looks along +y, z is up.
enum class NamedView { front, back, left, right, top, bottom, iso };
constexpr auto enum_words(NamedView) {
  using enum NamedView;
  return std::array{Word{"front", front}, Word{"back", back},     Word{"left", left}, Word{"right", right},
                    Word{"top", top},     Word{"bottom", bottom}, Word{"iso", iso}};
}

enum class ProjectionKind {
  perspective,
  parallel,  ///< no foreshortening
};
constexpr auto enum_words(ProjectionKind) {
  return std::array{Word{"perspective", ProjectionKind::perspective}, Word{"parallel", ProjectionKind::parallel}};
}

struct CameraParams {
  std::optional<NamedView> view;
  std::optional<Vec3> position, target, direction, up;
  double azimuth = 0, elevation = 0, roll = 0, zoom = 1, view_angle = 30;
  std::optional<ProjectionKind> projection;
};
void describe(Schema& s, CameraParams& p);

/// Words as given on the command line: a bare word is a view ("top") or a flag.
std::vector<std::string> camera_words(const std::vector<std::string>& words);

/// `direction`, `up`, `parallel`: what to use where nothing is stated. Throws Error(usage) when position and target coincide or
/// up lies along the view.
Camera make_camera(const CameraParams& params, const Box3& box, double aspect, Vec3 direction, Vec3 up, bool parallel, double margin);

}  // namespace sg
