// SPDX-License-Identifier: Apache-2.0
// Three pictures with noise of different kinds: a glossy room, a soft shadow, smoke.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "render/trace/integrators/bidirectional/light_scenes.h"
#include "render/trace/trace.h"
#include "render/volume/volume_support.h"

namespace sg::trace::test {

struct NoisyScene {
  std::string name;
  Scene scene;
  Projection projection;
  LightOptions options;
};

inline NoisyScene finished(std::string name, Scene scene, const Camera& camera, int width, int height) {
  scene.lighting.environment = EnvironmentParams(NoEnvironmentParams());
  LightOptions options;
  options.noise = 1e-6, options.bounces = 4;
  return {std::move(name), std::move(scene), make_projection(camera, width, height), options};
}

inline LightParams lamp(Vec3 position, double radius, double brightness = 1) {
  SphereLightParams l;
  l.place.position = position, l.radius = radius, l.strength.brightness = brightness;
  return l;
}

/// A room with a mirror-like, a rough and a diffuse ball, lit by a small lamp.
inline NoisyScene glossy_room(int width = 72, int height = 56) {
  LightScene s;
  add_room(s);
  SurfaceMaterial polished = diffuse(), brushed = preset_material(MaterialPreset::aluminium);
  polished.specular_weight = 1, polished.specular_roughness = 0.15, brushed.specular_roughness = 0.35;
  s.scene.items.emplace_back(ball({-0.45f, 0.2f, -0.55f}, 0.35f, 24, polished, 0.4));
  s.scene.items.emplace_back(ball({0.4f, 0.3f, -0.5f}, 0.4f, 24, brushed, 0.9));
  s.scene.lighting.lights = {lamp({0.3, -0.3, 0.6}, 0.1)};
  return finished("glossy room", s.scene, look({0, -3, 0}, {0, 0, 0}, 36), width, height);
}

/// A post on a floor of two colours under a wide lamp.
inline NoisyScene soft_shadow(int width = 72, int height = 56) {
  LightScene s;
  add_floor(s);
  s.scene.items.emplace_back(sheet({0, -0.9f, -0.899f}, {0.9f, 0, 0}, {0, 1.8f, 0}, diffuse(), 0.15));
  s.scene.items.emplace_back(sheet({-0.1f, 0, -0.9f}, {0.3f, 0.1f, 0}, {0, 0, 0.8f}, diffuse(), 0.6));
  s.scene.lighting.lights = {lamp({-0.6, 0.9, 0.9}, 0.4)};
  return finished("soft shadow", s.scene, look({0, -2.6, 0.9}, {0, 0, -0.6}, 36), width, height);
}

/// A puff in front of nothing, lit from the side.
inline NoisyScene smoke(int width = 72, int height = 56) {
  using namespace sg::test;
  VolumeItem v = item(grid(cube(25, -1, 1),
                           [](Vec3 p) {
                             const double waves = 0.3 * std::sin(7 * p.x) * std::sin(6 * p.y + 1) * std::sin(8 * p.z + 2);
                             return std::max(0.0, 0.8 - length(p) + waves);
                           }),
                      one_color({0.9f, 0.85f, 0.8f}), density_is_value(0, 1));
  v.unit_distance = 0.12, v.scattering.light = VolumeLighting::path;
  Scene scene = scene_of({v});
  scene.lighting.lights = {lamp({-2, -1, 1.5}, 0.3)};
  return finished("smoke", scene, look({0, -5, 0.5}, {0, 0, 0}, 26), width, height);
}

inline Frame picture_of(const NoisyScene& s, const LightOptions& options, TraceReport& report, const LightWatch& watch = {}) {
  Context context;
  return trace_scene(s.scene, prepare_scene(s.scene, context), s.projection, options, report, context, watch);
}
inline Frame picture_of(const NoisyScene& s, const LightOptions& options) {
  TraceReport report;
  return picture_of(s, options, report);
}

/// Root mean square of the differences of what is displayed, as a share of full scale.
inline double displayed_difference(const Frame& a, const Frame& b) {
  double sum = 0;
  for (size_t i = 0; i < a.rgba.size(); ++i) {
    if (i % 4 == 3) continue;
    const auto shown = [&](const Frame& f) { return double(srgb_encode(std::clamp(f.rgba[i], 0.f, 1.f))); };
    sum += std::pow(shown(a) - shown(b), 2);
  }
  return std::sqrt(sum / (3 * double(a.pixels())));
}

}  // namespace sg::trace::test
