// SPDX-License-Identifier: Apache-2.0
// One picture of a scene of bench/light/compare.py by the path tracer: linear colours as a file, times as a line.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <numbers>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/file/file.h"
#include "data/mesh.h"
#include "render/trace/trace.h"
#include "scene/camera.h"
#include "scene/scene.h"

namespace {

using namespace sg;

DatasetPtr read_mesh(const std::string& path) {
  const MappedFile file(path);
  const auto* bytes = reinterpret_cast<const char*>(file.data());
  uint64_t counts[2];
  std::memcpy(counts, bytes, sizeof counts);
  std::vector<float> xyz(3 * counts[0]);
  std::vector<int32_t> corners(3 * counts[1]);
  std::memcpy(xyz.data(), bytes + 16, 4 * xyz.size());
  std::memcpy(corners.data(), bytes + 16 + 4 * xyz.size(), 4 * corners.size());
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.polygons.connectivity = Array::from_vector(std::move(corners)), m.polygons.fixed = 3;
  return make_dataset(Mesh(std::move(m)));
}

/// In a cube of side 2 an extinction of 8 (1 - |p|^2) (0.55 + 0.45 sin 9x sin 9y sin 9z), nine tenths of it scattered to all sides.
Scene cloud() {
  constexpr size_t n = 129;
  UniformGrid grid;
  grid.dims = {n, n, n}, grid.origin = {-1, -1, -1}, grid.spacing = Vec3(2, 2, 2) / double(n - 1);
  std::vector<float> values;
  for (size_t i = 0; i < n * n * n; ++i) {
    const Vec3 p = grid.origin + Vec3(double(i % n), double(i / n % n), double(i / (n * n))) * (2 / double(n - 1));
    values.push_back(float(std::max(0.0, 1 - dot(p, p)) * (0.55 + 0.45 * std::sin(9 * p.x) * std::sin(9 * p.y) * std::sin(9 * p.z))));
  }
  FieldSet fields;
  fields.add({"density", Association::point, Array::from_vector(std::move(values)), "", Role::scalars});
  VolumeItem v;
  v.data = make_dataset(Mesh(std::move(grid)), std::move(fields)), v.field = "density";
  v.color.map.name = "white", v.color.map.colors = {{1, 1, 1}, {1, 1, 1}};
  v.unit_distance = 1e-4;  // so short that the opacity rises evenly with the value
  v.opacity.points = {{0, 0}, {1, 1 - std::exp(-8 * v.unit_distance)}};
  v.scattering.albedo = 0.9;
  Scene scene;
  scene.items.emplace_back(v);
  scene.lighting.environment = EnvironmentParams(EvenEnvironmentParams());
  scene.background = {0, 0, 0};
  return scene;
}

Scene scene_of(const DatasetPtr& mesh, const std::string& name) {
  Scene scene;
  SurfaceItem item;
  item.data = mesh, item.flat = true;
  SurfaceMaterial m;
  m.specular_weight = 0;
  const float albedo = srgb_encode(0.8f);
  item.color = {albedo, albedo, albedo};
  if (name == "metal") {
    m.base_metalness = 1, m.specular_weight = 1, m.specular_roughness = 0.3;
    item.color = {srgb_encode(0.9f), srgb_encode(0.6f), srgb_encode(0.3f)};
  }
  item.made_of = m;
  scene.items.emplace_back(item);
  EvenEnvironmentParams even;
  even.brightness = name == "even" ? 1 : 0.2;
  scene.lighting.environment = EnvironmentParams(even);
  if (name != "even") {
    SphereLightParams lamp;
    lamp.place.position = Vec3{3, 4, 2}, lamp.radius = 0.5;
    lamp.strength.power = 4 * std::numbers::pi * std::numbers::pi * 0.25 * 20;  // radiance 20
    scene.lighting.lights.emplace_back(lamp);
  }
  scene.background = {0, 0, 0};
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) {
    fmt::print(stderr, "usage: {} MESH.raw even|lamp|metal|occlusion|cloud PATHS WIDTH HEIGHT OUT.f32\n", argv[0]);
    return 2;
  }
  const Scene scene = std::string(argv[2]) == "cloud" ? cloud() : scene_of(read_mesh(argv[1]), argv[2]);
  Camera camera;
  camera.position = {2.2, 2.6, 3.6}, camera.target = {0, 0, 0}, camera.up = {0, 1, 0}, camera.view_angle = 40;
  camera.near_plane = 0.1, camera.far_plane = 100;
  const int width = std::atoi(argv[4]), height = std::atoi(argv[5]);
  Context context;
  LightOptions options;
  options.paths = std::atoi(argv[3]), options.noise = 1e-9;
  if (const char* b = std::getenv("BOUNCES")) options.bounces = std::atoi(b);
  if (const char* b = std::getenv("SEED")) options.seed = uint64_t(std::atoi(b));
  if (const char* b = std::getenv("SAMPLER")) options.sampler = trace::SamplerKind(std::atoi(b));
  if (std::string(argv[2]) == "occlusion") {  // of so many rays to the open, 16 for each from the camera
    options.integrator = trace::IntegratorKind::ambient_occlusion;
    options.paths = std::max(1, options.paths / 16);
  }
  const PreparedScenePtr prepared = prepare_scene(scene, context);
  const Projection projection = make_projection(camera, width, height);
  TraceReport report;
  LightOptions first = options;
  first.paths = 1;
  trace_scene(scene, prepared, make_projection(camera, 16, 9), first, report, context);  // the tree, off the clock
  if (const char* r = std::getenv("REPEAT"))
    for (int i = 0; i < std::atoi(r); ++i) {
      const std::clock_t w = std::clock();
      trace_scene(scene, prepared, projection, options, report, context);
      fmt::print("R {:.4f}\n", double(std::clock() - w) / CLOCKS_PER_SEC);
    }
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t work = std::clock();
  const Frame frame = trace_scene(scene, prepared, projection, options, report, context);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::string out;
  for (size_t i = 0; i < frame.pixels(); ++i) out.append(reinterpret_cast<const char*>(&frame.rgba[4 * i]), 12);
  write_file(argv[6], out);
  fmt::print("{:.4f} {:.4f}\n", seconds, double(std::clock() - work) / CLOCKS_PER_SEC);
}
