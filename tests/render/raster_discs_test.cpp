// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "raster_support.h"

using namespace sg;

namespace {

// A ball of discs, evenly spread, that overlap.
DatasetPtr ball(int n, float radius, Vec3 center = {}) {
  std::vector<float> xyz, normals, r;
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.0) / n, u = 2.399963229728653 * i, s = std::sqrt(1 - z * z);
    const double p[3] = {s * std::cos(u), s * std::sin(u), z};
    for (int c = 0; c < 3; ++c) xyz.push_back(float(center[c] + p[c])), normals.push_back(float(p[c]));
    r.push_back(radius);
  }
  FieldSet f;
  f.add({"Normals", Association::point, Array::from_vector(normals, 3), "", Role::normals});
  f.add({"radius", Association::point, Array::from_vector(r), "", Role::none});
  return make_dataset(Mesh(PointCloud{{Array::from_vector(xyz, 3), {}}}), f);
}

Frame picture(const Scene& scene, bool parallel, int size) {
  Camera c;
  c.position = {0, 0, 6};
  c.parallel = parallel, c.parallel_height = 3;
  c.near_plane = 1, c.far_plane = 20;
  Context ctx;
  Frame f(size, size);
  (void)rasterize(scene, make_projection(c, size, size), 1, f, ctx);
  return f;
}

Scene scene_of(const DatasetPtr& data) {
  PointsItem item;
  item.data = data;
  item.color = {0.8f, 0.8f, 0.8f};
  item.disc_normals = "Normals", item.disc_radius = "radius";
  Scene s;
  s.items.push_back(item);
  return s;
}

}  // namespace

TEST_CASE("discs: a ball of discs covers a circle, its depth is the sphere's, its light that of a sphere of triangles") {
  for (bool parallel : {true, false}) {
    const int n = 200;
    const Frame f = picture(scene_of(ball(3000, 0.06f)), parallel, n);
    Scene triangles;
    SurfaceItem s;
    s.data = test::sphere(60, 1);
    s.color = {0.8f, 0.8f, 0.8f};
    triangles.items.push_back(s);
    const Frame g = picture(triangles, parallel, n);
    size_t differ = 0, covered = 0;
    double worst = 0, light = 0;
    for (size_t p = 0; p < f.pixels(); ++p) {
      const bool a = f.ids[p] != 0, b = g.ids[p] != 0;
      differ += a != b;
      if (!a || !b) continue;
      ++covered;
      light += std::abs(double(f.rgba[4 * p]) - double(g.rgba[4 * p]));
      if (double(g.depth[p]) < 5.5) worst = std::max(worst, std::abs(double(f.depth[p]) - double(g.depth[p])));
    }
    CHECK(covered > 10000);
    CHECK(double(differ) < 0.03 * double(covered));
    CHECK(worst < 0.01);
    CHECK(light / double(covered) < 0.02);
  }
}

TEST_CASE("discs: hide and are hidden, tiny ones show, one seen from behind is lit, threads do not matter") {
  Scene s = scene_of(ball(2000, 0.08f));
  Scene behind = s;
  SurfaceItem wall;
  wall.data = test::quad(5, 2);  // before the ball
  behind.items.push_back(wall);
  const Frame f = picture(behind, true, 64);
  CHECK(f.ids[64 * 32 + 32] == 2);
  std::get<SurfaceItem>(behind.items[1]).data = test::quad(5, -2);
  const Frame g = picture(behind, true, 64);
  CHECK(g.ids[64 * 32 + 32] == 1);
  CHECK(g.ids[0] == 2);
  const Frame tiny = picture(scene_of(ball(2000, 1e-4f)), true, 64);
  CHECK(std::count_if(tiny.ids.begin(), tiny.ids.end(), [](uint32_t i) { return i != 0; }) > 500);
  set_thread_count(1);
  const Frame one = picture(behind, false, 150);
  set_thread_count(8);
  const Frame eight = picture(behind, false, 150);
  set_thread_count(0);
  CHECK(std::memcmp(one.rgba.data(), eight.rgba.data(), one.rgba.size() * sizeof(float)) == 0);
  PointsItem bad = std::get<PointsItem>(s.items[0]);
  bad.disc_radius = "Normals";
  s.items[0] = bad;
  CHECK(test::error_of([&] { picture(s, true, 8); }).find("components") != std::string::npos);
  std::get<PointsItem>(s.items[0]).disc_radius = "radii";
  CHECK(test::error_of([&] { picture(s, true, 8); }).find("radius") != std::string::npos);
}
