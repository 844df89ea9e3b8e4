// SPDX-License-Identifier: Apache-2.0
// The camera as a user states it: all parts optional, the rest is chosen from the data.
#pragma once
#include <optional>

#include "base/schema/schema.h"
#include "scene/camera.h"

namespace sg {

/// Named as an observer would, by ViewAxes.
enum class NamedView { front, back, left, right, top, bottom, iso };
constexpr auto enum_words(NamedView) {
  using enum NamedView;
  return std::array{Word{"front", front}, Word{"back", back},     Word{"left", left}, Word{"right", right},
                    Word{"top", top},     Word{"bottom", bottom}, Word{"iso", iso}};
}

/// Where the front, the left and the top of data lie, and what is at the upper edge of a view from the top or the bottom.
struct ViewAxes {
  Vec3 front{0, -1, 0}, left{-1, 0, 0}, up{0, 0, 1}, above{0, 1, 0};
};
/// Made for graphics: y is up, the front faces +z.
inline constexpr ViewAxes graphics_axes{{0, 0, 1}, {-1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
/// The patient frame. Left is the patient's own, which an observer in front has at the right; from the feet (bottom) the face is above, as
/// radiologists see axial slices.
inline constexpr ViewAxes patient_view_axes{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};

enum class ProjectionKind {
  perspective,
  parallel,  ///< no foreshortening
};
constexpr auto enum_words(ProjectionKind) {
  return std::array{Word{"perspective", ProjectionKind::perspective}, Word{"parallel", ProjectionKind::parallel}};
}

struct CameraParams {
  std::optional<NamedView> view;
  std::string file;  ///< name or number of a camera of the file that is shown; put in the place of the others when a picture is made
  std::optional<Vec3> position, target, direction, up;
  double azimuth = 0, elevation = 0, roll = 0, zoom = 1;
  std::optional<double> view_angle;  ///< degrees; 30 where neither this nor a camera of the file says more
  std::optional<ProjectionKind> projection;
  std::optional<double> height;
  double aperture = 0;          ///< diameter of the lens as a share of the depth in focus
  std::optional<double> focus;  ///< depth
  double shutter = 0;           ///< time that it is open
  int moments = 16;             ///< that are averaged meanwhile
};
void describe(Schema& s, CameraParams& p);

/// Words as given on the command line: a bare word is a view ("top"), a projection, or "file": its first camera.
std::vector<std::string> camera_words(const std::vector<std::string>& words);

/// What a camera is made of where nothing is stated.
struct CameraDefaults {
  Vec3 direction{0.75, -1.0, 0.55};  ///< from the data towards the viewer
  Vec3 up{0, 0, 1};
  bool parallel = false;
  ViewAxes axes;  ///< what named views mean
};

/// Throws Error(usage) when position and target coincide or up lies along the view.
Camera make_camera(const CameraParams& params, const Box3& box, double aspect, const CameraDefaults& defaults, double margin);

}  // namespace sg
