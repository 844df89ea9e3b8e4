// SPDX-License-Identifier: Apache-2.0
// Lines that belong to the picture, in pictures by paths of light: no light falls on them, and they hide none.
#include <cmath>

#include "render/render.h"
#include "scene/items/surface_material.h"
#include "scene/light/light_params.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

namespace {

constexpr int size = 24;

SurfaceItem paper(float half) {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<float>{-half, -half, 0, half, -half, 0, half, half, 0, -half, half, 0}, 3);
  m.polygons = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3}), {}, 4};
  SurfaceItem item;
  item.data = make_dataset(Mesh(std::move(m)));
  item.made_of = preset_material(MaterialPreset::matte);
  return item;
}

/// A sheet of half the picture's height before a line across all of it, under a camera that looks along -z.
Scene sheet_before_line(bool line, const char* environment) {
  Scene s;
  s.items.emplace_back(paper(0.5f));
  s.background = {0, 0, 0};
  s.lighting.lights = parse_lights("directional direction=1,1,1");
  s.lighting.environment = parse_environment(environment);
  if (!line) return s;
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::vector<float>{-3, 0, -1, 3, 0, -1}, 3);
  mesh.lines = {Array::from_vector(std::vector<int32_t>{0, 1}), {}, 2};
  LinesItem item;
  item.data = make_dataset(Mesh(std::move(mesh)));
  item.color = {0.7f, 0.7f, 0.7f}, item.width = 2, item.mark = true;
  s.items.emplace_back(item);
  return s;
}

Frame drawn(const Scene& s, trace::IntegratorKind integrator, bool denoise = false) {
  Camera camera;
  camera.position = {0, 0, 5}, camera.target = {0, 0, 0}, camera.up = {0, 1, 0}, camera.parallel = true, camera.parallel_height = 2;
  camera.near_plane = 0.1, camera.far_plane = 20;
  RenderOptions options;
  options.width = options.height = size;
  options.light.emplace();
  options.light->integrator = integrator, options.light->paths = 16, options.light->noise = 0.05, options.light->denoise = denoise;
  Context context;
  return render(s, camera, options, context);
}

const float* at(const Frame& f, int x, int y) { return &f.rgba[4 * (size_t(y) * size + size_t(x))]; }

}  // namespace

TEST_CASE("marks: a line of the picture is drawn in its colour behind the data, before what is around, and takes no light") {
  const float grey = srgb_decode(0.7f);
  for (const char* environment : {"none", "even brightness=0.25 background=true"})
    for (const auto integrator : {trace::IntegratorKind::path, trace::IntegratorKind::bdpt}) {
      CAPTURE(environment);
      const Frame with = drawn(sheet_before_line(true, environment), integrator),
                  without = drawn(sheet_before_line(false, environment), integrator);
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          const bool on_line = y == size / 2 || y == size / 2 - 1, beside_sheet = x < 5 || x > 18;
          if (on_line && beside_sheet) CHECK(double(at(with, x, y)[1]) == Approx(grey).epsilon(0.01));
          else if (std::abs(y - size / 2) > 2 || (x > 7 && x < 16))
            for (int c = 0; c < 4; ++c) CHECK(at(with, x, y)[c] == at(without, x, y)[c]);
        }
    }
  // The denoiser leaves it as it is.
  const Frame smooth = drawn(sheet_before_line(true, "sky elevation=30 background=true"), trace::IntegratorKind::path, true);
  for (const int x : {0, 3, 20, 23}) CHECK(double(at(smooth, x, size / 2)[1]) == Approx(grey).epsilon(0.01));
}
