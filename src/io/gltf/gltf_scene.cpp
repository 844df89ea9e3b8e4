// SPDX-License-Identifier: Apache-2.0
#include "io/gltf/gltf_scene.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "base/error.h"

namespace sg {

namespace {

constexpr double degrees = 180 / std::numbers::pi;
const char* const lights_extension = "KHR_lights_punctual";

double number_of(const Json& o, const char* key, double otherwise) {
  const Json* v = o.find(key);
  return !v ? otherwise : v->is_number() ? v->number() : NAN;
}

GltfCamera camera_of(const Json& o) {
  GltfCamera c;
  c.name = o["name"].text();
  const Json& lens = o[o["type"].text()];
  c.parallel = o["type"].text() == "orthographic";
  if (c.parallel) {
    c.height = 2 * std::abs(number_of(lens, "ymag", NAN));
    c.usable = std::isfinite(c.height) && c.height > 0;
  } else {
    c.view_angle = number_of(lens, "yfov", NAN) * degrees;
    c.usable = c.view_angle > 0 && c.view_angle < 180;
  }
  return c;
}

GltfLight light_of(const Json& o) {
  GltfLight l;
  l.name = o["name"].text();
  const std::string& type = o["type"].text();
  l.usable = true;
  if (type == "directional") l.shape = FileLight::Shape::directional;
  else if (type == "spot") l.shape = FileLight::Shape::spot;
  else l.usable = type == "point";
  l.intensity = number_of(o, "intensity", 1);
  l.usable = l.usable && l.intensity >= 0 && std::isfinite(l.intensity);
  if (const Json* color = o.find("color"))
    for (size_t a = 0; a < 3; ++a) {
      l.color[int(a)] = color->size() == 3 && (*color)[a].is_number() ? float((*color)[a].number()) : NAN;
      l.usable = l.usable && l.color[int(a)] >= 0 && std::isfinite(l.color[int(a)]);
    }
  l.inner = number_of(o["spot"], "innerConeAngle", 0) * degrees;
  l.outer = number_of(o["spot"], "outerConeAngle", std::numbers::pi / 4) * degrees;
  if (l.shape == FileLight::Shape::spot) l.usable = l.usable && l.inner >= 0 && l.outer > 0 && l.inner <= l.outer && l.outer <= 90.001;
  return l;
}

// f(node, matrix in the world) of the nodes of the scene, parents first. The document's reader has told of those that are no tree; here
// each node is met once.
template <class F>
void for_each_node(const GltfDocument& d, F&& f) {
  struct Visit {
    int node;
    Mat4 matrix;
  };
  std::vector<bool> seen(d.nodes.size(), false);
  std::vector<Visit> stack;
  for (size_t i = d.roots.size(); i-- > 0;) stack.push_back({d.roots[i], Mat4()});
  while (!stack.empty()) {
    const Visit v = stack.back();
    stack.pop_back();
    if (seen[size_t(v.node)]) continue;
    seen[size_t(v.node)] = true;
    const GltfNode& n = d.nodes[size_t(v.node)];
    const Mat4 m = v.matrix * n.matrix;
    f(n, m);
    for (size_t i = n.children.size(); i-- > 0;) stack.push_back({n.children[i], m});
  }
}

Vec3 direction(const Mat4& m, Vec3 v) {
  const Vec4 r = m * Vec4{v.x, v.y, v.z, 0};
  return normalize(Vec3(r.x, r.y, r.z));
}
bool is_place(Vec3 v) { return std::isfinite(v.x + v.y + v.z); }

std::string name_of(const std::string& node, const std::string& own, const char* what, size_t number) {
  return !node.empty() ? node : !own.empty() ? own : fmt::format("{} {}", what, number + 1);
}

int checked(const Json& o, const char* key, size_t count, const std::string& path, size_t node) {
  const Json* v = o.find(key);
  if (!v) return -1;
  if (!v->is_whole() || v->whole() >= count)
    fail_data(fmt::format("node {}: '{}' is {}, but there are {}", node, key, v->dump(), count), path);
  return int(v->whole());
}

}  // namespace

void take_cameras_and_lights(const Json& root, GltfDocument& d, Context& context) {
  for (const Json& o : root["cameras"].items()) d.cameras.push_back(camera_of(o));
  for (const Json& o : root["extensions"][lights_extension]["lights"].items()) d.lights.push_back(light_of(o));
  const std::vector<Json>& nodes = root["nodes"].items();
  for (size_t i = 0; i < nodes.size() && i < d.nodes.size(); ++i) {
    d.nodes[i].camera = checked(nodes[i], "camera", d.cameras.size(), d.path, i);
    d.nodes[i].light = checked(nodes[i]["extensions"][lights_extension], "light", d.lights.size(), d.path, i);
  }
  const auto tell = [&](const auto& all, const char* what) {
    size_t lost = 0;
    for (const auto& one : all) lost += !one.usable;
    if (lost > 0) context.warn(fmt::format("{}: {} of its {} are left out: their numbers make none", d.path, lost, what));
  };
  tell(d.cameras, "cameras"), tell(d.lights, "lights");
}

FileScene scene_of(const GltfDocument& d) {
  FileScene s;
  for_each_node(d, [&](const GltfNode& n, const Mat4& m) {
    const Vec3 at(m.m[0][3], m.m[1][3], m.m[2][3]), forward = direction(m, {0, 0, -1}), up = direction(m, {0, 1, 0});
    if (!is_place(at) || !(length(forward) > 0.5) || !(length(cross(forward, up)) > 1e-9)) return;
    if (n.camera >= 0 && d.cameras[size_t(n.camera)].usable) {
      const GltfCamera& c = d.cameras[size_t(n.camera)];
      s.cameras.push_back({name_of(n.name, c.name, "camera", s.cameras.size()), at, forward, up, c.parallel, c.view_angle, c.height});
    }
    if (n.light >= 0 && d.lights[size_t(n.light)].usable) {
      const GltfLight& l = d.lights[size_t(n.light)];
      s.lights.push_back({name_of(n.name, l.name, "light", s.lights.size()), l.shape, at, forward, l.color, l.intensity, l.inner, l.outer});
    }
  });
  return s;
}

void note_scene(const GltfDocument& d, Data& first) {
  if (d.cameras.empty() && d.lights.empty()) return;
  const FileScene s = scene_of(d);
  const auto names = [](const auto& all) {
    std::string r;
    for (const auto& one : all) r += (r.empty() ? "" : ", ") + one.name;
    return r;
  };
  DatasetParts parts = std::get<DatasetPtr>(first)->parts();
  if (!s.cameras.empty()) parts.notes.emplace_back(cameras_note, names(s.cameras));
  if (!s.lights.empty()) parts.notes.emplace_back(lights_note, names(s.lights));
  first = make_dataset(std::move(parts));
}

}  // namespace sg
