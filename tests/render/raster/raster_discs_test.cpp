// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "filter/surface/surfels.h"
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

TEST_CASE("discs: one seen at an angle covers pi r^2 cos(theta), lies in its plane and is lit by its own normal") {
  const int n = 800;
  const double scale = n / 3.0, r = 0.9;
  for (double theta : {0.0, 35.0, 60.0, 80.0}) {
    const double t = theta * test::pi / 180;
    const Vec3 normal{std::sin(t), 0, std::cos(t)};
    FieldSet f;
    f.add(
        {"Normals", Association::point, Array::from_vector(std::vector<float>{float(normal.x), 0, float(normal.z)}, 3), "", Role::normals});
    f.add({"radius", Association::point, Array::from_vector(std::vector<float>{float(r)}), "", Role::none});
    const DatasetPtr one = make_dataset(Mesh(PointCloud{{Array::from_vector(std::vector<float>{0.1f, 0.2f, 0.3f}, 3), {}}}), f);
    const Frame p = picture(scene_of(one), true, n);
    size_t covered = 0;
    double worst = 0;
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const size_t at = size_t(y) * size_t(n) + size_t(x);
        if (p.ids[at] == 0) continue;
        ++covered;
        // The plane through the place, in the picture's x; the viewer stands at z = 6.
        const double wx = (x + 0.5 - 0.5 * n) / scale - 0.1, wz = 0.3 - std::tan(t) * wx;
        worst = std::max(worst, std::abs(double(p.depth[at]) - (6 - wz)));
      }
    CHECK(double(covered) == doctest::Approx(test::pi * r * r * std::cos(t) * scale * scale).epsilon(0.004));
    CHECK(worst < 1e-3);
  }
}

TEST_CASE("discs: surfels of a ball on a grid leave no hole in its picture") {
  Context ctx;
  for (int cells : {12, 40}) {
    UniformGrid g;
    g.dims = {size_t(cells) + 1, size_t(cells) + 1, size_t(cells) + 1};
    g.origin = {-1.2, -1.2, -1.2};
    g.spacing = Vec3{2.4, 2.4, 2.4} * (1.0 / cells);
    std::vector<double> f;
    for (int k = 0; k <= cells; ++k)
      for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i) f.push_back(length(g.origin + g.spacing * Vec3(i, j, k)));
    FieldSet fields;
    fields.add({"f", Association::point, Array::from_vector(std::move(f)), "", Role::scalars});
    const DatasetPtr d = surfels(make_dataset(g, fields), {.field = {"f"}, .value = 1}, ctx);
    const int n = 300;
    for (bool parallel : {true, false}) {
      const Frame p = picture(scene_of(d), parallel, n);
      // Seen from (0, 0, 6), the ball's rim lies on a circle: of radius 1 in parallel, of tangent 1/sqrt(35) in perspective.
      const double rim = parallel ? n / 3.0 : 0.5 * n / std::tan(15 * test::pi / 180) / std::sqrt(35.0);
      size_t holes = 0;
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
          holes += std::hypot(x + 0.5 - 0.5 * n, y + 0.5 - 0.5 * n) < 0.985 * rim && p.ids[size_t(y) * size_t(n) + size_t(x)] == 0;
      CHECK(holes == 0);
    }
  }
}
