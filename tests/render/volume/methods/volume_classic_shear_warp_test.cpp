// SPDX-License-Identifier: Apache-2.0
// Shear-warp against closed forms and against the ray caster.
#include "data/memory/memo.h"
#include "render/volume/methods/encoded_volume.h"
#include "volume_classic_support.h"

using namespace sg;
using namespace sg::test;
using doctest::Approx;

TEST_CASE("shear-warp: a constant medium is exact away from the box's edges, opacity corrected for the shear and for perspective") {
  const VolumeItem v = item(grid(cube(17, -1, 1), [](Vec3) { return 1.0; }), one_color({0.8f, 0.4f, 0.2f}), constant_opacity(0.7));
  const auto layer = draw_layer(v, parallel_view(3, 3, 10), sheared());
  CHECK(layer.rgba[4 * 4] == Approx(0.8 * (1 - std::exp(-1.4))).epsilon(1e-5));
  CHECK(layer.rgba[4 * 4 + 3] == Approx(1 - std::exp(-1.4)).epsilon(1e-5));
  // Rays that pass through the same two faces, along each axis and from both sides.
  for (const Vec3 forward :
       {Vec3{0.2, 0.3, -1}, Vec3{-0.3, 0.1, 1}, Vec3{1, 0.2, 0.3}, Vec3{-1, 0.1, -0.2}, Vec3{0.1, 1, 0.2}, Vec3{0.2, -1, 0.1}}) {
    const Projection p = parallel_view(9, 9, 12, forward, {0.1, 0.2, 1});
    CHECK(distance(draw_layer(v, p, sheared()).rgba, ray_cast(v, p, 0.05).rgba).most < 2e-5);
    const Projection q = perspective_view(9, 9, 80, forward * -4, {0, 0, 0}, {0.1, 0.2, 1});
    CHECK(distance(draw_layer(v, q, sheared()).rgba, ray_cast(v, q, 0.05).rgba).most < 5e-4);
  }
}

TEST_CASE("shear-warp: a sphere of constant density darkens by exp(-2 sigma sqrt(R^2-b^2)) away from the rim") {
  const double sigma = 1.2;
  const DatasetPtr d = grid(cube(65, -1.3, 1.3), [&](Vec3 p) { return length(p) - 1; });
  OpacityCurve curve;
  curve.points = {{-10, 1 - std::exp(-sigma)}, {0, 1 - std::exp(-sigma)}, {1e-9, 0}, {10, 0}};
  const auto layer = draw_layer(item(d, one_color({1, 1, 1}), curve), parallel_view(12, 12, 12 / 1.3, {0.3, -0.2, -1}), sheared());
  double most = 0;
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 12; ++x)
      if (const double b = std::hypot(x - 5.5, y - 5.5) * 1.3 / 12; b < 0.7)
        most = std::max(most, std::abs(1 - double(layer.rgba[size_t(4 * (12 * y + x) + 3)]) - std::exp(-2 * sigma * std::sqrt(1 - b * b))));
  INFO("error " << most);
  CHECK(most < 0.006);  // voxels are in or out: up to half of one at each end of the chord
}

TEST_CASE("shear-warp: the projection of a Gaussian ball") {
  const double s = 0.3;
  const DatasetPtr d = grid(cube(97, -1.8, 1.8), [&](Vec3 p) { return std::exp(-dot(p, p) / (2 * s * s)); });
  for (const double b : {0.0, 0.2, 0.5}) {
    const auto layer = draw_layer(item(d, one_color({1, 1, 1}), density_is_value(0, 1, 20000)),
                                  parallel_view(1, 1, 30, {0, 0, -1}, {0, 1, 0}, {b, 0, 0}), sheared());
    CHECK(-std::log(1 - double(layer.rgba[3])) == Approx(s * std::sqrt(2 * M_PI) * std::exp(-b * b / (2 * s * s))).epsilon(4e-3));
  }
}

TEST_CASE("shear-warp: a smooth scene is that of the ray caster within the error of pre-classified voxels, less with a finer picture") {
  for (const bool shaded : {false, true})
    for (const Projection& p : some_views()) {
      const VolumeItem v = smooth_item(49, shaded);
      const Distance one = from_rays(v, p, sheared(1), 0.002), two = from_rays(v, p, sheared(2), 0.002);
      INFO("shaded " << shaded << " one " << one.rms << " " << one.most << " two " << two.rms << " " << two.most);
      CHECK(one.rms < 0.003);
      CHECK(one.most < (shaded ? 0.04 : 0.02));
      CHECK(two.rms < 1.05 * one.rms);
    }
}

TEST_CASE("shear-warp: anisotropic and rotated grids, cells and holes") {
  const auto f = [](Vec3 p) { return p.z > 0.3 && p.x > 0.4 ? NAN : std::exp(-2 * dot(p, p)) + 0.1 * p.x; };
  OpacityCurve curve;
  curve.points = {{0.1, 0}, {0.5, 0.4}, {1, 0.9}};
  UniformGrid g;
  g.dims = {41, 49, 31}, g.spacing = {0.04, 0.03, 0.06};
  const double c = std::cos(0.5), s = std::sin(0.5);
  g.direction.m[0][0] = c, g.direction.m[0][1] = -s, g.direction.m[1][0] = s, g.direction.m[1][1] = c;
  g.origin = g.direction * (g.spacing * Vec3{-20, -24, -15});
  VolumeItem v = item(grid(g, f), grey(0, 1), curve);
  v.unit_distance = 0.3, v.shaded = true;
  for (const Projection& p : some_views(32)) CHECK(from_rays(v, p, sheared(), 0.005).rms < 0.01);  // voxels beside a hole reach into it
  // One value per cell: constant to the very sides.
  FieldSet fields;
  fields.add({"f", Association::cell, Array::from_vector(std::vector<double>(512, 1.0)), "", Role::scalars});
  v = item(make_dataset(cube(9, -1, 1), fields), one_color({1, 1, 1}), constant_opacity(0.5));
  v.association = Association::cell;
  const auto layer = draw_layer(v, parallel_view(19, 1, 10), sheared(4));
  for (int x = 1; x < 18; ++x) CHECK(layer.rgba[size_t(4 * x + 3)] == Approx(1 - std::exp(-1.0)).epsilon(1e-4));
}

TEST_CASE("shear-warp: maximum and minimum along axis-parallel rays are those of the samples") {
  const DatasetPtr d = grid(cube(9, 0, 8), [](Vec3 p) { return std::sin(1.7 * p.x + 3.1 * p.y) + 0.2 * p.z * std::cos(p.x * p.z); });
  double most = -HUGE_VAL, least = HUGE_VAL;
  for (int k = 0; k < 9; ++k) {
    const double f = std::sin(1.7 * 3 + 3.1 * 5) + 0.2 * k * std::cos(3.0 * k);
    most = std::max(most, f), least = std::min(least, f);
  }
  for (const RayFunction mode : {RayFunction::maximum, RayFunction::minimum}) {
    VolumeItem v = item(d, grey(-20, 20), constant_opacity(1));
    v.mode = mode;
    const auto layer = draw_layer(v, parallel_view(1, 1, 1, {0, 0, -1}, {0, 1, 0}, {3, 5, 4}), sheared());
    CHECK(std::abs(double(layer.rgba[0]) * 40 - 20 - (mode == RayFunction::maximum ? most : least)) < 0.1);
  }
  VolumeItem v = smooth_item(49);
  v.mode = RayFunction::maximum, v.opacity = constant_opacity(1);
  for (const Projection& p : some_views(32)) CHECK(from_rays(v, p, sheared(2), 0.01).rms < 0.02);  // the silhouette's pixels
}

TEST_CASE("shear-warp: nothing is drawn behind a surface, and what lies before one is seen") {
  const VolumeItem v = item(grid(cube(65, -1, 1), [](Vec3) { return 1.0; }), one_color({1, 1, 1}), constant_opacity(1));
  for (const double z : {1.5, 0.4, -0.7, -3.0}) {
    const Projection p = parallel_view(3, 3, 20), q = perspective_view(3, 3, 100, {0, 0, 6}, {0, 0, 0});
    Frame opaque(3, 3);
    const double want = 1 - std::exp(-std::clamp(1 - z, 0.0, 2.0));
    std::fill(opaque.depth.begin(), opaque.depth.end(), float(100 - z));
    CHECK(std::abs(double(draw_layer(v, p, sheared(), &opaque).rgba[19]) - want) < 0.03);
    std::fill(opaque.depth.begin(), opaque.depth.end(), float(6 - z));
    CHECK(std::abs(double(draw_layer(v, q, sheared(), &opaque).rgba[19]) - want) < 0.03);
  }
}

TEST_CASE("shear-warp: directions survive 16 bits to a degree, and the encoding is kept per transfer function") {
  for (uint64_t i = 0; i < 300; ++i) {
    const Vec3f d = normalize(Vec3f{float(random_unit(1, i)) - 0.5f, float(random_unit(2, i)) - 0.5f, float(random_unit(3, i)) - 0.5f});
    REQUIRE(dot(d, volume::direction_of(volume::direction_code(d))) > std::cos(0.0175));
  }
  VolumeItem v = smooth_item(33);
  const Projection p = parallel_view(8, 8, 3);
  const auto first = draw_layer(v, p, sheared());
  const size_t kept = v.data->memo().bytes();
  CHECK(kept > 0);
  CHECK(draw_layer(v, p, sheared()).rgba == first.rgba);
  CHECK(v.data->memo().bytes() == kept);
  v.opacity.points = {{0.2, 0}, {0.4, 0.9}};
  const auto other = draw_layer(v, p, sheared());
  CHECK(other.rgba != first.rgba);
  v.data = smooth_item(33).data;
  CHECK(draw_layer(v, p, sheared()).rgba == other.rgba);
}

TEST_CASE("shear-warp: the same bytes from one thread and from eight") {
  for (const int view : {0, 2}) {
    set_thread_count(1);
    const auto one = draw_layer(smooth_item(33, true), some_views(130)[size_t(view)], sheared());
    set_thread_count(8);
    const auto eight = draw_layer(smooth_item(33, true), some_views(130)[size_t(view)], sheared());
    set_thread_count(0);
    CHECK(std::memcmp(one.rgba.data(), eight.rgba.data(), one.rgba.size() * 4) == 0);
  }
}

TEST_CASE("shear-warp: an eye inside the volume, rectilinear grids and other ray functions are refused in words") {
  VolumeItem v = smooth_item(9);
  CHECK(refused(v, perspective_view(4, 4, 4, {0, 0.1, 0}, {1, 0, 0}), sheared(), "inside the volume"));
  v.mode = RayFunction::sum;
  CHECK(refused(v, parallel_view(4, 4, 1), sheared(), "method=ray"));
  RectilinearGrid r;
  r.x = r.y = r.z = Array::from_vector(std::vector<double>{0, 1, 3});
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::vector<double>(27, 1.0)), "", Role::scalars});
  v = smooth_item(9), v.data = make_dataset(r, fields);
  CHECK(refused(v, parallel_view(4, 4, 1), sheared(), "rectilinear"));
}
