// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/view_camera.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "base/text/text.h"

namespace sg::serve {

namespace {

Json list_of(Vec3 v) { return Json(std::vector<Json>{Json(v.x), Json(v.y), Json(v.z)}); }

std::string text_of(Vec3 v) { return fmt::format("{},{},{}", exact_number(v.x), exact_number(v.y), exact_number(v.z)); }

[[noreturn]] void fail_camera(const std::string& what) {
  fail_usage(what, "camera", "it has position, target and up, three finite numbers each, and view_angle or height");
}

Vec3 vector_from(const Json& camera, std::string_view name) {
  const Json& list = camera[name];
  Vec3 v;
  for (int a = 0; a < 3; ++a) {
    v[a] = list[size_t(a)].number();
    if (!list[size_t(a)].is_number() || !std::isfinite(v[a])) fail_camera(fmt::format("'{}' is not a vector", name));
  }
  return v;
}

}  // namespace

ViewCamera view_camera(const Camera& c) { return {c.position, c.target, c.up, c.parallel, c.view_angle, c.parallel_height}; }

CameraParams camera_params(const ViewCamera& c) {
  CameraParams p;
  p.position = c.position, p.target = c.target, p.up = c.up;
  p.projection = c.parallel ? ProjectionKind::parallel : ProjectionKind::perspective;
  if (c.parallel) p.height = c.height;
  else p.view_angle = c.view_angle;
  return p;
}

std::vector<std::string> camera_texts(const ViewCamera& c) {
  std::vector<std::string> words{"position=" + text_of(c.position), "target=" + text_of(c.target), "up=" + text_of(c.up),
                                 c.parallel ? "projection=parallel" : "projection=perspective"};
  if (c.parallel) words.push_back("height=" + exact_number(c.height));
  else if (c.view_angle != 30) words.push_back("view_angle=" + exact_number(c.view_angle));
  return words;
}

Json camera_json(const ViewCamera& c) {
  return Json(Json::Members{{"position", list_of(c.position)},
                            {"target", list_of(c.target)},
                            {"up", list_of(c.up)},
                            {"parallel", Json(c.parallel)},
                            {"view_angle", Json(c.view_angle)},
                            {"height", Json(c.height)}});
}

ViewCamera camera_from(const Json& json) {
  ViewCamera c;
  c.position = vector_from(json, "position"), c.target = vector_from(json, "target"), c.up = vector_from(json, "up");
  c.parallel = json["parallel"].boolean();
  if (json.contains("view_angle")) c.view_angle = json["view_angle"].number();
  if (json.contains("height")) c.height = json["height"].number();
  if (!(c.view_angle >= 1 && c.view_angle <= 170)) fail_camera("the view angle is not between 1 and 170 degrees");
  if (c.parallel && !(c.height > 0 && std::isfinite(c.height))) fail_camera("the height of a parallel view is not above 0");
  const Vec3 sight = c.position - c.target;
  if (!(length(sight) > 0) || !(length(cross(sight, c.up)) > 0)) fail_camera("position and target coincide, or up lies along the view");
  return c;
}

std::optional<ViewCamera> stated_camera(const Json& message) {
  const Json& camera = message["camera"];
  if (camera.is_null()) return std::nullopt;
  return camera_from(camera);
}

}  // namespace sg::serve
