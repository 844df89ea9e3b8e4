// SPDX-License-Identifier: Apache-2.0
// The same picture for any number of threads, any vector width, and from the plain code.
#include <hwy/targets.h>

#include "raster_support.h"
#include "render/shade/shade.h"

using namespace sg;
using namespace sg::test;

namespace {

/// Everything at once: small and large triangles, near clipping, translucency, lines, dots, edges, every kind of colour.
Scene full_scene() {
  Scene s;
  SurfaceItem a = item(torus(160, 80, true));
  a.color_by = grey_by("height", -0.3, 0.3);
  SurfaceItem b = item(torus(21, 13), {0.2f, 0.7f, 0.4f});
  b.opacity = 0.5, b.edges = true, b.color_by = grey_by("height", -0.2, 0.2), b.color_by->scale.clamp = false;
  SurfaceItem floor = item(surface({-9, -9, -0.6f, 9, -9, -0.6f, 9, 9, -0.6f, -9, 9, -0.6f}, {0, 1, 2, 0, 2, 3}), {0.3f, 0.3f, 0.9f});
  SurfaceMesh wire = triangle_mesh({-1, -1, 0.5f, 1, 1, 0.5f, 1, -1, 0.6f}, {});
  wire.polygons = {}, wire.lines = {Array::from_vector<int32_t>({0, 1, 2}), {}, 3};
  LinesItem l;
  l.data = make_dataset(wire), l.width = 3;
  PointsItem p;
  p.data = torus(12, 7), p.size = 7, p.opacity = 0.7;
  s.items = {a, b, floor, l, p};
  return s;
}

Camera full_camera() {
  Camera c;
  c.position = {2.2, -2.5, 1.4}, c.up = {0, 0, 1}, c.view_angle = 45, c.near_plane = 0.05;
  return c;
}

}  // namespace

TEST_CASE("raster: 1 and 8 threads draw the same bytes") {
  const Scene s = full_scene();
  for (const bool parallel : {false, true}) {
    Camera c = full_camera();
    c.parallel = parallel, c.parallel_height = 3;
    set_thread_count(1);
    const Picture one = draw(s, c, 333, 222, 2);
    set_thread_count(8);
    const Picture eight = draw(s, c, 333, 222, 2);
    set_thread_count(0);
    CHECK(one.covered() > 20000);
    CHECK_FALSE(one.fragments.empty());
    CHECK(same_bytes(one, eight));
  }
}

TEST_CASE("raster: every vector target draws the same bytes") {
  const Scene s = full_scene();
  const Picture best = draw(s, full_camera(), 333, 222, 2);
  const auto targets = hwy::SupportedAndGeneratedTargets();
  for (int64_t target : targets) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    CAPTURE(target);
    CHECK(same_bytes(best, draw(s, full_camera(), 333, 222, 2)));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  CHECK(targets.size() > 1);
}

TEST_CASE("raster: a prepared scene draws what the scene draws") {
  const Scene s = full_scene();
  const Picture p = draw(s, full_camera(), 200, 150);
  Context context;
  const PreparedScenePtr prepared = prepare_scene(s, context);
  for (int k = 0; k < 2; ++k) {
    Picture q;
    q.frame = Frame(200, 150);
    q.fragments = rasterize_prepared(*prepared, make_projection(full_camera(), 200, 150), 1, q.frame, context);
    CHECK(same_bytes(p, q));
  }
}

TEST_CASE("raster: vector shading agrees with the plain one") {
  namespace r = sg::raster;
  using namespace r;
  Scene s;
  SurfaceItem a = item(torus(60, 40, true));
  a.color_by = grey_by("height", -0.3, 0.3), a.material.power = 13.7f;
  SurfaceItem b = item(torus(30, 20), {0.5f, 0.4f, 0.3f});
  b.flat = true;
  s.items = {a, b};
  Context context;
  const PreparedScenePtr prepared = prepare_scene(s, context);
  const Camera c = full_camera();
  const Projection projection = make_projection(c, 256, 256);
  const auto lights = lamps_of(prepared->lights, projection);
  for (const PreparedItem& it : prepared->items) {
    const ShadeJob job = shade_job(it, eye_view(projection, it.triangles.origin), lights);
    // The pixel in the middle of each triangle, where its centre is inside.
    double worst = 0;
    size_t tested = 0;
    for (uint32_t t = 0; t < it.triangles.count; ++t) {
      Vec3 q[3], s[3];
      for (int k = 0; k < 3; ++k) {
        const float* v = it.triangles.xyz() + 3 * size_t(it.triangles.indices()[3 * t + uint32_t(k)]);
        q[k] = Vec3(v[0], v[1], v[2]), s[k] = projection.to_pixel(q[k]);
      }
      const Vec3 at = projection.to_pixel((q[0] + q[1] + q[2]) / 3.0);
      if (at.x < 0 || at.y < 0 || at.x >= 256 || at.y >= 256) continue;
      double edge[3];
      for (int k = 0; k < 3; ++k) edge[k] = cross(s[(k + 1) % 3] - s[k], Vec3{std::floor(at.x) + 0.5, std::floor(at.y) + 0.5, 0} - s[k]).z;
      if (std::min({edge[0], edge[1], edge[2]}) < 0 && std::max({edge[0], edge[1], edge[2]}) > 0) continue;
      if (std::abs(dot(normalize(cross(q[1] - q[0], q[2] - q[0])), normalize(q[0] - projection.eye))) < 0.05) continue;
      ShadeBatch x, y;
      x.n = y.n = 1;
      x.tile_x = y.tile_x = int(at.x) / tile_size * tile_size, x.tile_y = y.tile_y = int(at.y) / tile_size * tile_size;
      x.pixel[0] = y.pixel[0] = uint32_t(int(at.y) % tile_size * tile_size + int(at.x) % tile_size), x.triangle[0] = y.triangle[0] = t;
      shade(job, x), shade_reference(job, y);
      worst = std::max({worst, std::abs(double(x.light[0]) - double(y.light[0])), std::abs(double(x.gloss[0]) - double(y.gloss[0])),
                        std::abs(double(x.depth[0]) - double(y.depth[0]))});
      for (int k = 0; k < 4; ++k) worst = std::max(worst, std::abs(double(x.rgba[k][0]) - double(y.rgba[k][0])));
      ++tested;
    }
    CHECK(tested > 100);
    CAPTURE(worst);
    CHECK(worst < 3e-4);  // a step of the colour table is 2.4e-4
  }
}
