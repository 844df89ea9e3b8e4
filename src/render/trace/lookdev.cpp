// SPDX-License-Identifier: Apache-2.0
#include "render/trace/lookdev.h"

#include <cmath>
#include <vector>

#include "render/composite/background.h"
#include "render/trace/trace.h"

namespace sg {

namespace {

constexpr double pi = 3.14159265358979;

DatasetPtr unit_ball(Vec3 middle) {
  constexpr int rings = 64, spokes = 128;
  std::vector<float> xyz;
  std::vector<int32_t> ids;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s < spokes; ++s) {
      const double down = pi * r / rings, around = 2 * pi * s / spokes;
      xyz.insert(xyz.end(), {float(middle.x + std::sin(down) * std::cos(around)), float(middle.y + std::sin(down) * std::sin(around)),
                             float(middle.z + std::cos(down))});
      if (r == rings) continue;
      const int a = r * spokes + s, b = r * spokes + (s + 1) % spokes;
      if (r > 0) ids.insert(ids.end(), {a, b + spokes, b});
      if (r + 1 < rings) ids.insert(ids.end(), {a, a + spokes, b + spokes});
    }
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.polygons = {Array::from_vector(std::move(ids)), {}, 3};
  return make_dataset(Mesh(std::move(m)));
}

// Squares of two greys, whose edges show what glass bends and mirrors show.
DatasetPtr floor_of_squares() {
  constexpr int n = 24;
  std::vector<float> xyz;
  std::vector<int32_t> ids;
  std::vector<uint8_t> colors;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      xyz.insert(xyz.end(), {float(i - n / 2), float(j - n / 2), 0.f});
      if (i == n || j == n) continue;
      const int a = j * (n + 1) + i;
      ids.insert(ids.end(), {a, a + 1, a + n + 2, a + n + 1});
      const uint8_t grey = (i + j) % 2 ? 205 : 120;
      colors.insert(colors.end(), {grey, grey, grey});
    }
  DatasetParts parts;
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.polygons = {Array::from_vector(std::move(ids)), {}, 4};
  parts.mesh = std::move(m);
  parts.fields.add({"colors", Association::cell, Array::from_vector(std::move(colors), 3), "", Role::colors});
  return make_dataset(std::move(parts));
}

}  // namespace

Image lookdev_ball(const SurfaceMaterial& material, int width, double noise, Context& context) {
  Scene scene;
  SurfaceItem ground;
  ground.data = floor_of_squares();
  ground.color_by = FieldColor{"colors", Association::cell, -1, {}, true};
  scene.items.emplace_back(ground);
  SurfaceItem ball;
  ball.data = unit_ball({0, 0, 1});
  ball.made_of = material;
  const Vec3f own(material.base_color);
  ball.color = {srgb_encode(own.x), srgb_encode(own.y), srgb_encode(own.z)};
  scene.items.emplace_back(ball);
  scene.background = {0.86f, 0.88f, 0.9f};
  Camera camera;
  camera.position = {0, -6.2, 3}, camera.target = {0, 0, 0.85}, camera.up = {0, 0, 1}, camera.view_angle = 26;
  camera.near_plane = 0.1, camera.far_plane = 100;
  LightOptions options;
  options.noise = noise, options.paths = 256, options.bounces = 24;
  options.sampler = trace::SamplerKind::sobol;
  TraceReport report;
  Frame frame = trace_scene(scene, prepare_scene(scene, context), make_projection(camera, width, width), options, report, context);
  composite_background(scene, frame);
  return to_image(frame);
}

}  // namespace sg
