// SPDX-License-Identifier: Apache-2.0
// A thin lens: what is in focus is sharp, what is not a disc of the size that similar triangles give.
#include <cmath>
#include <string>

#include "render/raster/raster_support.h"
#include "render/trace/trace.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

namespace {

constexpr int side = 64;

/// How far light spreads across the picture of a small square that shines, seen along -z from `depth` in front of it: the variance of the
/// places of its light in pixels, both axes together.
double spread(double depth, Camera camera) {
  SurfaceItem item;
  item.data = test::quad(0.02f, 0);
  SurfaceMaterial shines;
  shines.base_color = {0, 0, 0}, shines.specular_weight = 0, shines.emission = {1, 1, 1};
  item.made_of = shines;
  Scene scene;
  scene.items.emplace_back(item);
  scene.lighting.environment = parse_environment("none");
  scene.background = {0, 0, 0};  // before white it could not be told
  camera.position = {0, 0, depth}, camera.target = {0, 0, 0}, camera.up = {0, 1, 0}, camera.near_plane = depth / 2,
  camera.far_plane = 2 * depth;
  const Projection p = make_projection(camera, side, side);
  Context context;
  LightOptions options;
  options.noise = 1e-4, options.paths = 512;
  TraceReport report;
  const Frame frame = trace_scene(scene, prepare_scene(scene, context), p, options, report, context);
  double sum = 0, x1 = 0, y1 = 0, squares = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double v = double(frame.rgba[4 * (size_t(y) * side + size_t(x))]);
      sum += v, x1 += v * (x + 0.5), y1 += v * (y + 0.5), squares += v * ((x + 0.5) * (x + 0.5) + (y + 0.5) * (y + 0.5));
    }
  REQUIRE(sum > 0);
  CHECK(x1 / sum == Approx(side / 2).epsilon(0.02));
  return squares / sum - (x1 / sum) * (x1 / sum) - (y1 / sum) * (y1 / sum);
}

/// The same of an even disc of that diameter, a quarter of its radius' square along each axis, with the square's and the pixel's own.
double blurred(double circle, double square) { return circle * circle / 8 + square * square / 6 + 1.0 / 6; }

}  // namespace

TEST_CASE("lens: a point in focus is as sharp as of a pinhole, others are discs of A |d - f| / d on the plane in focus") {
  Camera camera;
  camera.view_angle = 30;
  const double scale = side / 2 / std::tan(15 * 3.14159265358979 / 180);
  for (const double depth : {4.0, 6.0}) {
    camera.lens = 0;
    const double sharp = spread(depth, camera);
    camera.lens = 1.2;
    camera.focus = depth;
    CHECK(spread(depth, camera) == Approx(sharp).epsilon(0.03));
    for (const double focus : {0.8 * depth, 1.3 * depth}) {
      camera.focus = focus;
      CAPTURE(focus);
      CHECK(spread(depth, camera) ==
            Approx(blurred(camera.lens * std::abs(depth - focus) / depth * scale / focus, 0.04 * scale / depth)).epsilon(0.03));
    }
  }
}

TEST_CASE("lens: of a parallel projection too, and one that makes no picture is refused") {
  Camera camera;
  camera.parallel = true, camera.parallel_height = 2;
  const double sharp = spread(4, camera);
  camera.lens = 0.5, camera.focus = 4;
  CHECK(spread(4, camera) == Approx(sharp).epsilon(0.03));
  camera.focus = 3;
  CHECK(spread(4, camera) == Approx(blurred(0.5 * (4.0 - 3) / 3 * side / 2, 0.04 * side / 2)).epsilon(0.03));
  camera.focus = 0;
  CHECK_THROWS_AS(make_projection(camera, 8, 8), Error);
  camera.focus = 1, camera.lens = -1;
  CHECK_THROWS_AS(make_projection(camera, 8, 8), Error);
}
