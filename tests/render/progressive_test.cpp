// SPDX-License-Identifier: Apache-2.0
#include "render/progressive.h"

#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("progressive: pictures come coarse first and nearer to the last each time; the last is that of render()") {
  VolumeItem v = item(grid(cube(33, -1, 1), [](Vec3 p) { return std::exp(-3 * dot(p, p)); }), grey(0, 1), {{{0.1, 0}, {1, 0.8}}});
  v.unit_distance = 0.1;
  const Scene scene = scene_of({v});
  const Camera camera = fit_camera(scene_bounds(scene), {1, 0.6, 2}, {0, 1, 0}, 1.25);
  RenderOptions options;
  options.width = 125, options.height = 99;
  Context context;
  const Frame want = render(scene, camera, options, context);
  std::vector<int> coarseness;
  std::vector<double> off;
  const Frame last = render_progressively(scene, camera, options, context, [&](const Frame& f, int c) {
    REQUIRE(f.width == 125);
    double sum = 0;
    for (size_t i = 0; i < f.rgba.size(); ++i) sum += std::abs(double(f.rgba[i]) - double(want.rgba[i]));
    coarseness.push_back(c), off.push_back(sum / double(f.rgba.size()));
    return true;
  });
  CHECK(coarseness == std::vector<int>{8, 4, 2, 1});
  CHECK(same_bytes(last, want));
  for (size_t i = 1; i < off.size(); ++i) CHECK(off[i] < 0.7 * off[i - 1]);
  CHECK(off[0] < 0.05);

  int seen = 0;
  render_progressively(scene, camera, options, context, [&](const Frame&, int) { return ++seen < 2; });
  CHECK(seen == 2);
}
