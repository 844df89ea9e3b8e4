// SPDX-License-Identifier: Apache-2.0
// Where a window looks from, as it is told between window, session and renderer, and as the words of a picture.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/text/json.h"
#include "scene/camera_params.h"

namespace sg::serve {

struct ViewCamera {
  Vec3 position{0, 0, 1}, target, up{0, 1, 0};
  bool parallel = false;
  double view_angle = 30;  ///< degrees; perspective
  double height = 1;       ///< world length from the lower to the upper edge; parallel
  friend bool operator==(const ViewCamera&, const ViewCamera&) = default;
};

ViewCamera view_camera(const Camera& camera);
CameraParams camera_params(const ViewCamera& camera);
/// "position=1,2,3", ... under `camera` of a picture: they give the same numbers again.
std::vector<std::string> camera_texts(const ViewCamera& camera);
Json camera_json(const ViewCamera& camera);
/// Throws Error(usage) for numbers that are no camera.
ViewCamera camera_from(const Json& json);
/// "camera" of a message; nothing where it has none.
std::optional<ViewCamera> stated_camera(const Json& message);

}  // namespace sg::serve
