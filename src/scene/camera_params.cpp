// SPDX-License-Identifier: Apache-2.0
#include "scene/camera_params.h"

#include <numbers>

#include "base/error.h"

namespace sg {

namespace {

struct View {
  Vec3 direction, up;
};
View view_of(NamedView view, const ViewAxes& a) {
  switch (view) {
    case NamedView::front: return {a.front, a.up};
    case NamedView::back: return {-a.front, a.up};
    case NamedView::left: return {a.left, a.up};
    case NamedView::right: return {-a.left, a.up};
    case NamedView::top: return {a.up, a.above};
    case NamedView::bottom: return {-a.up, a.above};
    case NamedView::iso: break;
  }
  return {a.front + cross(a.up, a.front) + a.up * 0.8, a.up};
}

// v turned about a unit axis (Rodrigues).
Vec3 turned(Vec3 v, Vec3 axis, double degrees) {
  const double a = degrees * std::numbers::pi / 180, c = std::cos(a), s = std::sin(a);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

}  // namespace

void describe(Schema& s, CameraParams& p) {
  s("view", p.view,
    "Named view; default: chosen from the data. Front is towards -y and z is up; of graphics (.obj, .gltf...) front is towards +z and y is "
    "up; of scans front is the patient's front, left the patient's left, and bottom the axial view from the feet.");
  s("file", p.file,
    "Look through a camera of the file that is shown (glTF): its name or its number, from 1; --camera file: the first. sightglass info "
    "names them. Its place, direction and angle of view are taken where nothing else is stated.");
  s("position", p.position, "Position of the camera; default: far enough away to see everything.");
  s("target", p.target, "Point to look at; default: the centre of the data.");
  s("direction", p.direction, "Direction from the data towards the camera.");
  s("up", p.up, "Direction that points up in the picture.");
  s("azimuth", p.azimuth, "Rotation about the up direction.").unit("deg");
  s("elevation", p.elevation, "Angle by which the camera is raised.").unit("deg").range(-180, 180);
  s("roll", p.roll, "Rotation about the line of sight.").unit("deg");
  s("zoom", p.zoom, "Magnification; above 1 is closer.").positive();
  s("view_angle", p.view_angle, "Vertical angle of view; default: 30, or that of the file's camera.").unit("deg").range(1, 170);
  s("projection", p.projection, "Perspective or parallel projection; default: parallel for flat data.");
  s("height", p.height, "Of a parallel projection: what is seen from the lower to the upper edge; default: all of the data.").positive();
  s("aperture", p.aperture,
    "Of pictures by paths of light: diameter of the lens as a share of the distance that is sharp. A point at another distance d is seen "
    "as "
    "a disc of aperture |d - focus| / d radians; 0: all is sharp.")
      .range(0, 1);
  s("focus", p.focus,
    "With an aperture: distance from the camera, along the line of sight, of what is sharp; default: the middle of the data.")
      .positive();
  s("shutter", p.shutter,
    "Motion blur: time that the shutter is open, the picture's own time in its middle; nodes of a scene that have keys move meanwhile, and "
    "so do steps that state a time. 0: "
    "none.")
      .unit("time")
      .range(0, 1e30);
  s("moments", p.moments, "With a shutter: moments that are drawn and averaged.").range(2, 4096);
}

std::vector<std::string> camera_words(const std::vector<std::string>& words) {
  std::vector<std::string> r;
  for (const std::string& w : words) {
    if (w.find('=') != std::string::npos) r.push_back(w);
    else if (value_of_word<ProjectionKind>(w)) r.push_back("projection=" + w);
    else if (w == "file") r.push_back("file=1");
    else r.push_back("view=" + w);
  }
  return r;
}

Camera make_camera(const CameraParams& p, const Box3& box, double aspect, const CameraDefaults& defaults, double margin) {
  Vec3 direction = defaults.direction, up = defaults.up;
  bool parallel = defaults.parallel;
  if (p.view) direction = view_of(*p.view, defaults.axes).direction, up = view_of(*p.view, defaults.axes).up;
  if (p.direction) direction = *p.direction;
  if (p.up) up = *p.up;
  if (p.position && p.target) direction = *p.position - *p.target;
  else if (p.position) direction = *p.position - box.center();
  if (!(length(direction) > 0))
    fail_usage("the camera has no direction to look along", "camera", "position and target must differ; direction must not be 0,0,0");
  if (!(length(up) > 0)) fail_usage("up must not be 0,0,0", "camera up");
  if (length(cross(normalize(direction), normalize(up))) < 1e-9) {
    if (p.up) fail_usage("up is parallel to the line of sight", "camera up", "choose another up");
    up = defaults.axes.above;
  }
  up = normalize(up);
  if (p.azimuth != 0) direction = turned(direction, up, p.azimuth);
  if (p.elevation != 0) {
    const Vec3 side = normalize(cross(up, direction));
    direction = turned(direction, side, -p.elevation);
    up = turned(up, side, -p.elevation);
  }
  if (p.roll != 0) up = turned(up, normalize(direction), p.roll);
  if (p.projection) parallel = p.projection == ProjectionKind::parallel;

  Camera c = fit_camera(box, direction, up, aspect, margin, p.view_angle.value_or(Camera().view_angle), parallel);
  if (p.target || p.position) {
    const Vec3 target = p.target ? *p.target : box.center();
    const double distance = p.position ? length(*p.position - target) : length(c.position - c.target);
    c.target = target;
    c.position = target + normalize(direction) * distance;
  }
  if (p.height) c.parallel_height = *p.height;
  if (p.zoom != 1) {
    if (parallel) c.parallel_height /= p.zoom;
    else if (p.position) c.view_angle = std::atan(std::tan(c.view_angle * std::numbers::pi / 360) / p.zoom) * 360 / std::numbers::pi;
    else c.position = c.target + (c.position - c.target) / p.zoom;
  }
  fit_planes(c, box);
  const double middle = box.empty() ? 0 : dot(box.center() - c.position, c.forward());
  c.focus = p.focus.value_or(middle > 0 ? middle : length(c.target - c.position));
  c.lens = p.aperture * c.focus;
  return c;
}

}  // namespace sg
