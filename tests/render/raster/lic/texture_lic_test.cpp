// SPDX-License-Identifier: Apache-2.0
// Image-space LIC: its statistics, where lines go and where they must not, and the same bytes from any code.
#include <hwy/targets.h>

#include "texture_support.h"

using namespace sg;
using namespace sg::test;
using raster::LicPlanes;

TEST_CASE("lic: a plane seen face on has variance 1, correlation 1 - k/L along the flow and none across") {
  for (const double angle : {0.0, std::atan2(3.0, 4.0)}) {
    const Vec3 v{std::cos(angle), std::sin(angle), 0};
    SurfaceItem s = textured(sheet(4, 2, 0, [&](Vec3) { return v; }), 20, 1, LicKernel::box);
    s.lic->grain = 1;
    const LicPlanes p = planes(scene_of({s}), front_parallel(2), 400, 400);
    double mean = 0, square = 0;
    size_t n = 0;
    for (int y = 40; y < 360; ++y)
      for (int x = 40; x < 360; ++x, ++n) mean += double(p.value[p.at(x, y)]), square += std::pow(double(p.value[p.at(x, y)]), 2);
    CAPTURE(angle);
    CHECK(std::abs(mean / double(n)) < 0.05);
    CHECK(square / double(n) == doctest::Approx(1).epsilon(0.2));
    for (const int k : {5, 10, 20, 30}) {
      const int dx = int(std::lround(k * v.x)), dy = -int(std::lround(k * v.y));
      CHECK(correlation(p, dx, dy, 45) == doctest::Approx(1 - k / 41.0).epsilon(0.25));
    }
    for (const int k : {5, 9}) CHECK(std::abs(correlation(p, -int(std::lround(k * v.y)), -int(std::lround(k * v.x)), 45)) < 0.1);
  }
}

TEST_CASE("lic: contrast hardly depends on kernel, step, grain and length of the lines") {
  for (const LicKernel kernel : {LicKernel::hann, LicKernel::box})
    for (const double grain : {1.0, 1.5, 4.0})
      for (const int steps : {10, 40}) {
        SurfaceItem s = textured(sheet(4, 2, 0, [](Vec3) { return Vec3{0.8, 0.6, 0}; }), steps, 0.5, kernel);
        s.lic->grain = grain;
        const LicPlanes p = planes(scene_of({s}), front_parallel(2), 300, 300);
        double square = 0, count = 0;
        for (int y = 30; y < 270; ++y)
          for (int x = 30; x < 270; ++x, ++count) square += std::pow(double(p.value[p.at(x, y)]), 2);
        CAPTURE(grain);
        CAPTURE(steps);
        CHECK(square / count > 0.6);
        CHECK(square / count < 1.6);
      }
}

TEST_CASE("lic: in a flow that turns about an axis the texture is constant along circles") {
  SurfaceItem s = textured(sheet(64, 1, 0, [](Vec3 p) { return Vec3{-p.y, p.x, 0}; }), 40, 0.5);
  const LicPlanes p = planes(scene_of({s}), front_parallel(2), 256, 256);
  double along = 0, across = 0, own = 0;
  for (int r = 40; r < 110; ++r)
    for (int k = 0; k < 360; ++k) {
      const auto value = [&](double radius, double angle) {
        return double(p.value[p.at(int(128 + radius * std::cos(angle)), int(128 + radius * std::sin(angle)))]);
      };
      const double a = k * pi / 180, v = value(r, a);
      own += v * v, along += v * value(r, a + 4.0 / r), across += v * value(r + 4, a);
    }
  CHECK(along / own > 0.7);
  CHECK(across / own < 0.25);
}

TEST_CASE("lic: without a direction the plain colour shows") {
  const Camera c = front_parallel(2);
  const auto half = [](Vec3 value) { return [=](Vec3 p) { return p.x < -0.01 ? value : Vec3{0, 1, 0}; }; };
  const Picture plain = draw(scene_of({item(sheet(40, 1, 0, half({})), {0.7f, 0.7f, 0.7f}, false)}), c, 128, 128);
  for (const Vec3 none : {Vec3{0, 0, 0}, Vec3{NAN, 1, 0}, Vec3{0, 0, 3}}) {
    const Picture p = draw(scene_of({textured(sheet(40, 1, 0, half(none)))}), c, 128, 128);
    size_t same = 0, changed = 0;
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x) {
        const bool equal = p.rgba(x, y)[0] == plain.rgba(x, y)[0];
        if (x < 60) same += equal;
        else if (x > 66) changed += !equal;
      }
    CHECK(same == 60 * 128);
    CHECK(changed > 61 * 128 * 9 / 10);
  }
}

TEST_CASE("lic: a sheet's texture does not feel what is behind its border") {
  const auto sheet_at = [](double a, double z) { return sheet(8, a, z, [](Vec3) { return Vec3{1, 0.3, 0}; }); };
  // Both sheets as one mesh and one item.
  const DatasetPtr small = sheet_at(0.5, 0.4), large = sheet_at(1, 0);
  const auto xyz = [](const DatasetPtr& d) { return d->as<SurfaceMesh>()->points.xyz.view<float>(); };
  std::vector<float> points, vectors;
  std::vector<int32_t> corners;
  for (const DatasetPtr& d : {small, large}) {
    const int first = int(points.size() / 3);
    for (size_t i = 0; i < d->point_count(); ++i)
      for (int k = 0; k < 3; ++k) points.push_back(xyz(d)(i, k)), vectors.push_back(k == 0 ? 1.0f : k == 1 ? 0.3f : 0.0f);
    const auto t = d->as<SurfaceMesh>()->polygons.connectivity.view<int32_t>();
    for (size_t i = 0; i < t.count; ++i) corners.push_back(first + t[i]);
  }
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::move(vectors), 3), "", Role::vectors});
  const DatasetPtr both = surface(points, corners, f);
  for (const bool parallel : {true, false}) {
    Camera c = front(3, 45);
    c.parallel = parallel, c.parallel_height = 2.2;
    const LicPlanes alone = planes(scene_of({textured(small)}), c, 200, 200), together = planes(scene_of({textured(both)}), c, 200, 200);
    size_t n = 0, different = 0;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x)
        if (const size_t i = alone.at(x, y); alone.item[i] > 0) ++n, different += alone.value[i] != together.value[i];
    CHECK(n > 2000);
    CHECK(different == 0);
  }
}

TEST_CASE("lic: lines cross the creases of one sheet") {
  // A roof: two planes that meet at x = 0, seen from above.
  FieldSet f;
  f.add(
      {"v", Association::point, Array::from_vector<float>({1, 0, 1, 1, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0, -1, 1, 0, -1}, 3), "", Role::vectors});
  const DatasetPtr roof = surface({-1, -1, -1, -1, 1, -1, 0, -1, 0, 0, 1, 0, 1, -1, -1, 1, 1, -1}, {0, 2, 3, 0, 3, 1, 2, 4, 5, 2, 5, 3}, f);
  const LicPlanes p = planes(scene_of({textured(roof, 20, 1, LicKernel::box)}), front_parallel(2), 200, 200);
  double own = 0, joint = 0;
  for (int y = 0; y < 200; ++y)
    own += std::pow(double(p.value[p.at(98, y)]), 2), joint += double(p.value[p.at(98, y)]) * double(p.value[p.at(102, y)]);
  CHECK(joint / own > 0.75);
  // And not over an edge behind which the next sheet lies deeper.
  CHECK((p.word[p.at(99, 100)] >> raster::neighbor_bit(1, 0) & 1) == 1);
}

TEST_CASE("lic: noise sticks to the surface when the camera moves") {
  const Scene s = scene_of({textured(sheet(4, 3, 0.1, [](Vec3) { return Vec3{1, 0, 0}; }))});
  Camera c = front_parallel(2);
  const LicPlanes a = planes(s, c, 200, 200);
  c.position.x += 0.17, c.target.x += 0.17;  // 17 pixels
  const LicPlanes b = planes(s, c, 200, 200);
  size_t same = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 180; ++x) same += a.noise[a.at(x + 17, y)] == b.noise[b.at(x, y)];
  CHECK(same > 200 * 180 * 98 / 100);
}

TEST_CASE("lic: cell vectors that are all alike give the texture of point vectors") {
  const DatasetPtr d = sheet(6, 1, 0, [](Vec3) { return Vec3{0.2, 1, 0}; });
  DatasetParts parts = d->parts();
  std::vector<float> v;
  for (size_t i = 0; i < d->cell_count(); ++i) v.insert(v.end(), {0.2f, 1, 0});
  parts.fields = {};
  parts.fields.add({"v", Association::cell, Array::from_vector(v, 3), "", Role::vectors});
  SurfaceItem s = textured(make_dataset(parts));
  s.lic->association = Association::cell;
  const LicPlanes a = planes(scene_of({textured(d)}), front_parallel(2), 100, 100), b = planes(scene_of({s}), front_parallel(2), 100, 100);
  double worst = 0;
  for (size_t i = 0; i < a.value.size(); ++i)
    if (a.item[i]) worst = std::max(worst, std::abs(double(a.value[i]) - double(b.value[i])));
  CHECK(worst < 0.01);
}

namespace {

Scene everything() {
  const auto flow = [](Vec3 p) { return Vec3{-p.y + 0.2, p.x, std::sin(3 * p.x)}; };
  const DatasetPtr t = torus(60, 40);
  const auto xyz = t->as<SurfaceMesh>()->points.xyz.view<float>();
  std::vector<float> v;
  for (size_t i = 0; i < t->point_count(); ++i) {
    const Vec3 q = flow({xyz(i, 0), xyz(i, 1), xyz(i, 2)});
    for (int c = 0; c < 3; ++c) v.push_back(float(q[c]));
  }
  DatasetParts parts = t->parts();
  parts.fields.add({"v", Association::point, Array::from_vector(v, 3), "", Role::vectors});
  SurfaceItem a = textured(make_dataset(parts)), b = textured(sheet(5, 1.5, 0.2, flow), 13, 0.8);
  a.material.lit = true, b.opacity = 0.5;
  return scene_of({a, b, item(sphere(9, 0.5f))});
}

Camera oblique() {
  Camera c;
  c.position = {2.2, -2.5, 1.9}, c.up = {0, 0, 1}, c.view_angle = 45, c.near_plane = 0.05;
  return c;
}

}  // namespace

TEST_CASE("lic: 1 and 8 threads draw the same bytes, opaque and translucent") {
  const Scene s = everything();
  for (const bool parallel : {false, true}) {
    Camera c = oblique();
    c.parallel = parallel, c.parallel_height = 3;
    set_thread_count(1);
    const Picture one = draw(s, c, 333, 222);
    set_thread_count(8);
    const Picture eight = draw(s, c, 333, 222);
    set_thread_count(0);
    CHECK(one.covered() > 10000);
    CHECK_FALSE(one.fragments.empty());
    CHECK(same_bytes(one, eight));
  }
}

TEST_CASE("lic: every vector target draws the same bytes") {
  const Scene s = everything();
  const Picture best = draw(s, oblique(), 333, 222);
  const auto targets = hwy::SupportedAndGeneratedTargets();
  for (const int64_t target : targets) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    CAPTURE(target);
    CHECK(same_bytes(best, draw(s, oblique(), 333, 222)));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

TEST_CASE("lic: vector code agrees with the plain one") {
  Context context;
  const Scene scene = everything();
  for (const bool parallel : {false, true}) {
    Camera c = oblique();
    c.parallel = parallel, c.parallel_height = 3;
    const Projection projection = make_projection(c, 201, 150);
    const auto prepared = prepare_scene(scene, context);
    const auto textures = texture_scene(*prepared, projection, context);
    LicPlanes p = textures->layers[0];
    const raster::PreparedItem& it = prepared->items[0];
    const raster::EyeView view = raster::eye_view(projection, it.triangles.origin);

    LicPlanes q = p;
    for (uint32_t& w : q.word) w &= 0xFFFFFF00u;
    raster::connect_pixels_reference(q, view, 0, q.height);
    CHECK(same_bytes(p.word, q.word));

    raster::LicWeights weights = raster::lic_weights(*it.lic, it.lic->grain / it.lic->step);
    std::vector<int32_t> pixels;
    for (int y = 0; y < p.height; ++y)
      for (int x = 0; x < p.width; ++x)
        if (p.item[p.at(x, y)]) pixels.push_back(int32_t(p.at(x, y)));
    CHECK(pixels.size() > 3000);
    raster::convolve_reference({q.word.data(), q.noise.data(), q.value.data(), int(q.stride), float(it.lic->step), &weights}, pixels.data(),
                               pixels.size());
    size_t equal = 0;
    for (const int32_t i : pixels) equal += p.value[size_t(i)] == q.value[size_t(i)];
    CHECK(equal == pixels.size());

    // Points in the middle of triangles.
    raster::VectorJob job{};
    job.view = view, job.xyz = it.triangles.xyz(), job.triangles = it.triangles.indices(), job.grain = 1.5f, job.seed = 3;
    job.vectors = reinterpret_cast<const float*>(it.lic_vectors.raw());
    size_t compared = 0, noise = 0;
    double worst_way = 0, worst_w = 0;
    auto a = std::make_unique<raster::VectorBatch>(), b = std::make_unique<raster::VectorBatch>();
    for (uint32_t t = 0; t < it.triangles.count; t += 3) {
      Vec3 mid, corner[3];
      for (int k = 0; k < 3; ++k) {
        const float* v = it.triangles.xyz() + 3 * size_t(it.triangles.indices()[3 * t + uint32_t(k)]);
        corner[k] = Vec3(v[0], v[1], v[2]), mid += corner[k] / 3.0;
      }
      const Vec3 at = projection.to_pixel(mid), n = normalize(cross(corner[1] - corner[0], corner[2] - corner[0]));
      if (at.x < 0 || at.y < 0 || at.x >= 201 || at.y >= 150) continue;
      if (std::abs(dot(n, parallel ? projection.forward : normalize(mid - projection.eye))) < 0.3) continue;
      a->n = b->n = 1, a->x[0] = b->x[0] = int(at.x), a->y[0] = b->y[0] = int(at.y), a->triangle[0] = b->triangle[0] = t;
      raster::pixel_vectors(job, *a), raster::pixel_vectors_reference(job, *b);
      const auto part = [](uint32_t w, int shift) { return double(int32_t(w << shift) >> 20); };
      ++compared;
      const float z = a->w[0] / b->w[0];
      if (std::abs(double(z) - 1) > 1e-3) continue;  // the pixel lies beside its triangle: the vector code stays inside
      worst_way =
          std::max({worst_way, std::abs(part(a->word[0], 0) - part(b->word[0], 0)), std::abs(part(a->word[0], 12) - part(b->word[0], 12))});
      worst_w = std::max(worst_w, std::abs(double(a->wx[0]) - double(b->wx[0])) / std::abs(double(b->w[0])));
      noise += std::abs(double(a->noise[0]) - double(b->noise[0])) < 1e-3;
    }
    CHECK(compared > 200);
    CHECK(worst_way < 200);  // of 2047: beside the triangle vectors are held, not extrapolated
    CHECK(worst_w < 1e-3);
    CHECK(noise > compared / 2);
  }
}
