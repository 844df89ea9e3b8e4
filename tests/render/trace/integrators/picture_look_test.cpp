// SPDX-License-Identifier: Apache-2.0
// What of the colours of items is made of a picture's pixels: by paths as by the rasterizer.
#include <cmath>

#include "render/raster/lic/texture_support.h"
#include "render/raster/raster_support.h"
#include "render/trace/trace.h"
#include "support/test.h"

using namespace sg;

namespace {

Frame picture_by(const Scene& scene, const Camera& camera, int size, std::optional<trace::IntegratorKind> integrator, int paths = 4) {
  Context context;
  RenderOptions o;
  o.width = o.height = size;
  if (integrator) o.light.emplace(), o.light->integrator = *integrator, o.light->paths = paths;
  return render(scene, camera, o, context);
}

}  // namespace

TEST_CASE("trace: the texture of a flow is that of the rasterizer, pixel by pixel, opaque and translucent") {
  for (const double opacity : {1.0, 0.5}) {
    SurfaceItem sheet = test::textured(test::sheet(16, 4, 0, [](Vec3 p) { return Vec3{-p.y, p.x, 0}; }), 10);
    sheet.opacity = opacity;
    const Scene scene = test::scene_of({sheet});  // unlit; to paths flat and in the open, so that all light arrives
    const Frame drawn = picture_by(scene, test::front_parallel(2), 120, {}),
                traced = picture_by(scene, test::front_parallel(2), 120, trace::IntegratorKind::ambient_occlusion);
    float lo = 9, hi = 0;
    int others = 0;
    for (size_t i = 0; i < drawn.rgba.size(); i += 4) {
      others += std::abs(drawn.rgba[i] - traced.rgba[i]) > 1e-4f;
      lo = std::min(lo, traced.rgba[i]), hi = std::max(hi, traced.rgba[i]);
    }
    CAPTURE(opacity);
    CHECK(others <= 3);  // where a path at the border of its pixel is rounded over it
    CHECK(hi > (opacity == 1 ? 2 : 1.2f) * lo);
  }
}

TEST_CASE("trace: edges of cells fade where there is no room for them, and are gone below three pixels") {
  const auto darkness = [](int cells, bool edges, trace::IntegratorKind integrator) {
    SurfaceItem sheet = test::item(test::sheet(cells, 1, 0, [](Vec3) { return Vec3(); }), {1, 1, 1});
    sheet.edges = edges;
    const Frame f = picture_by(test::scene_of({sheet}), test::front_parallel(2), 100, integrator);
    double sum = 0;
    for (size_t i = 0; i < f.rgba.size(); i += 4) sum += 1 - double(f.rgba[i]);
    return sum / double(f.pixels());
  };
  for (const auto integrator : {trace::IntegratorKind::ambient_occlusion, trace::IntegratorKind::whitted}) {
    // Squares of 25, 5 and 2 pixels: room for lines, for two fifths of each (darker by the lines' own share of a cell), for none.
    const double without = darkness(4, false, integrator), far = darkness(50, true, integrator), roomy = darkness(4, true, integrator);
    CHECK(roomy > without + 0.02);
    CHECK(far == doctest::Approx(darkness(50, false, integrator)).epsilon(1e-6));
  }
}
