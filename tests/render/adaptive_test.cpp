// SPDX-License-Identifier: Apache-2.0
// Adaptive supersampling: all samples where they are needed, the single one elsewhere.
#include "render/render.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("adaptive samples: edges are those of full supersampling, smooth parts those of one sample") {
  // A sharp ball: its rim needs samples, its inside and the air do not.
  VolumeItem v =
      item(grid(cube(65, -1, 1), [](Vec3 p) { return length(p); }), one_color({0.9f, 0.3f, 0.1f}), {{{0, 0.9}, {0.7, 0.9}, {0.7, 0}}});
  v.unit_distance = 0.02;
  const Scene scene = scene_of({v});
  const Camera camera = fit_camera(scene_bounds(scene), {0.3, 0.2, 1}, {0, 1, 0}, 1.2);
  RenderOptions options;
  options.width = 96, options.height = 80;
  Context context;
  const auto shot = [&](int samples, double adaptive) {
    options.samples = samples, options.adaptive = adaptive;
    return render(scene, camera, options, context);
  };
  const Frame one = shot(1, 0), full = shot(4, 0), adaptive = shot(4, 1.0 / 64);
  CHECK(largest_difference(one, full) > 0.2f);
  CHECK(largest_difference(adaptive, full) < 1.0f / 32);
  size_t single = 0;
  for (size_t p = 0; p < one.pixels(); ++p) single += std::memcmp(&one.rgba[4 * p], &adaptive.rgba[4 * p], 16) == 0;
  CHECK(single > one.pixels() / 2);
  CHECK(same_bytes(adaptive, shot(4, 1.0 / 64)));
  CHECK(largest_difference(shot(3, 1.0 / 64), shot(3, 0)) < 1.0f / 32);  // squares that are no whole tiles
  CHECK(same_bytes(shot(1, 0.5), one));
}

TEST_CASE("adaptive samples: silhouettes of level sets are those of two samples, without being asked for") {
  for (const RayFunction mode : {RayFunction::isosurface, RayFunction::first_hit}) {
    VolumeItem v = item(grid(cube(33, -1, 1), [](Vec3 p) { return 1 - length(p); }), one_color({0.5f, 0.5f, 0.5f}), {{{0, 1}}});
    v.mode = mode, v.levels = {0.3}, v.shaded = false;
    const Scene scene = scene_of({v});
    const Camera camera = fit_camera(scene_bounds(scene), {0.3, 0.2, 1}, {0, 1, 0}, 1.2);
    Context context;
    const auto shot = [&](int samples) {
      RenderOptions options;
      options.width = 96, options.height = 80, options.samples = samples;
      return render(scene, camera, options, context);
    };
    CHECK(largest_difference(shot(0), shot(2)) < 1.0f / 32);
    CHECK(largest_difference(shot(1), shot(2)) > 0.2f);
  }
}
