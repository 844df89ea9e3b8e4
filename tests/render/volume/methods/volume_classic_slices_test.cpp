// SPDX-License-Identifier: Apache-2.0
// Object-order slicing against closed forms and against the ray caster.
#include "volume_classic_support.h"

using namespace sg;
using namespace sg::test;
using doctest::Approx;
using Stack = volume::SliceOptions::Stack;

TEST_CASE("slices: a constant medium is exact for any distance of the slices, any stack and either order") {
  UniformGrid g = cube(9, -0.75, 0.75);
  for (const double step : {0.0, 0.1, 0.37, 7.0})
    for (const Stack stack : {Stack::view, Stack::axis})
      for (const bool forward : {true, false}) {
        const VolumeItem v = item(grid(g, [](Vec3) { return 1.0; }), one_color({0.8f, 0.4f, 0.2f}), constant_opacity(2), step);
        const auto layer = draw_layer(v, parallel_view(1, 1, 1, {0, 0, -1}, {0, 1, 0}, {0.01, 0.02, 0}), sliced(stack, forward));
        INFO("step " << step << " stack " << int(stack));
        CHECK(layer.rgba[0] == Approx(0.76017035).epsilon(1e-5));
        CHECK(1 - layer.rgba[3] == Approx(0.04978707).epsilon(1e-4));
        // Oblique and perspective: the length of the ray in the box decides.
        for (const Projection& p : {parallel_view(9, 9, 5, {0.3, 0.6, -1}), perspective_view(9, 9, 12, {1, 1.4, 2}, {0, 0, 0}),
                                    perspective_view(9, 9, 5, {0.1, 0.2, 0.15}, {-1, 0.3, -2})}) {
          const Frame want = ray_cast(v, p, 0.05);
          CHECK(distance(draw_layer(v, p, sliced(stack, forward)).rgba, want.rgba).most < 2e-5);
        }
      }
}

TEST_CASE("slices: a sphere of constant density darkens by exp(-2 sigma sqrt(R^2-b^2))") {
  const double sigma = 1.2;
  const DatasetPtr d = grid(cube(65, -1.3, 1.3), [&](Vec3 p) { return length(p) - 1; });
  OpacityCurve curve;
  curve.points = {{-10, 1 - std::exp(-sigma)}, {0, 1 - std::exp(-sigma)}, {1e-9, 0}, {10, 0}};
  for (const Stack stack : {Stack::view, Stack::axis}) {
    const auto layer =
        draw_layer(item(d, one_color({1, 1, 1}), curve, 0.02), parallel_view(12, 12, 12 / 1.3, {0.3, -0.2, -1}), sliced(stack));
    double most = 0;
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 12; ++x) {
        const double b = std::hypot(x - 5.5, y - 5.5) * 1.3 / 12;
        if (b < 0.7)
          most =
              std::max(most, std::abs(1 - double(layer.rgba[size_t(4 * (12 * y + x) + 3)]) - std::exp(-2 * sigma * std::sqrt(1 - b * b))));
      }
    INFO("error " << most);
    // A slice is in or out: up to one slice's length at each end of the chord.
    CHECK(most < (stack == Stack::view ? 0.006 : 0.012));
  }
}

TEST_CASE("slices: the projection of a Gaussian ball") {
  const double s = 0.3;
  const DatasetPtr d = grid(cube(97, -1.8, 1.8), [&](Vec3 p) { return std::exp(-dot(p, p) / (2 * s * s)); });
  for (const Stack stack : {Stack::view, Stack::axis})
    for (const double b : {0.0, 0.2, 0.5}) {
      const auto layer = draw_layer(item(d, one_color({1, 1, 1}), density_is_value(0, 1, 20000)),
                                    parallel_view(1, 1, 1, {0, 0, -1}, {0, 1, 0}, {b, 0, 0}), sliced(stack));
      CHECK(-std::log(1 - double(layer.rgba[3])) == Approx(s * std::sqrt(2 * M_PI) * std::exp(-b * b / (2 * s * s))).epsilon(2e-3));
    }
}

TEST_CASE("slices: a smooth scene is that of the ray caster within the error of its slices") {
  for (const bool shaded : {false, true})
    for (const Projection& p : some_views()) {
      const VolumeItem v = smooth_item(49, shaded);
      const Distance view = from_rays(v, p, sliced(Stack::view), 0.002), axis = from_rays(v, p, sliced(Stack::axis), 0.002);
      INFO("view " << view.rms << " " << view.most << " axis " << axis.rms << " " << axis.most);
      CHECK(view.rms < 5e-4);
      CHECK(view.most < (shaded ? 2e-2 : 4e-3));  // where the gradient turns away from the viewer the lit side changes
      CHECK(axis.rms < 2e-3);
      CHECK(axis.most < (shaded ? 4e-2 : 1.5e-2));
      CHECK(distance(draw_layer(v, p, sliced(Stack::view, true)).rgba, draw_layer(v, p, sliced(Stack::view, false)).rgba).most < 4e-4);
    }
}

TEST_CASE("slices: rectilinear, rotated and anisotropic grids, cells, holes and clip planes as the ray caster") {
  const auto f = [](Vec3 p) { return std::exp(-2 * dot(p, p)) + 0.1 * p.x; };
  OpacityCurve curve;
  curve.points = {{0.1, 0}, {0.5, 0.4}, {1, 0.9}};
  std::vector<VolumeItem> items;
  UniformGrid g;
  g.dims = {21, 33, 15}, g.origin = {-0.8, -0.5, -1}, g.spacing = {0.08, 0.04, 0.12};
  const double c = std::cos(0.5), s = std::sin(0.5);
  g.direction.m[0][0] = c, g.direction.m[0][1] = -s, g.direction.m[1][0] = s, g.direction.m[1][1] = c;
  items.push_back(item(grid(g, f), grey(0, 1), curve));
  RectilinearGrid r;
  std::vector<double> places, values;
  for (int i = 0; i <= 30; ++i) places.push_back(1 - 2 * std::pow(i / 30.0, 1.4));
  r.x = r.y = r.z = Array::from_vector(places);
  for (const double z : places)
    for (const double y : places)
      for (const double x : places) values.push_back(z > 0.3 && x > 0.4 ? NAN : f({x, y, z}));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(values), "", Role::scalars});
  items.push_back(item(make_dataset(r, fields), grey(0, 1), curve));
  for (VolumeItem& v : items)
    for (const Projection& p : some_views(32)) {
      v.unit_distance = 0.3, v.shaded = true, v.sampling.step = 0.01;
      const Distance d = from_rays(v, p, sliced(), 0.002);
      INFO(d.rms << " " << d.most);
      CHECK(d.rms < 2.5e-3);  // values beside a hole jump
      CHECK(from_rays(v, p, sliced(Stack::axis), 0.002).rms < 1.2e-2);
    }
  // Half of a constant medium is clipped away.
  VolumeItem v = item(grid(cube(9, -1, 1), [](Vec3) { return 1.0; }), one_color({1, 1, 1}), constant_opacity(1));
  v.clip.push_back({{0, 0, 1}, 0.3});
  CHECK(draw_layer(v, parallel_view(1, 1, 1), sliced()).rgba[3] == Approx(1 - std::exp(-1.3)).epsilon(1e-5));
}

TEST_CASE("slices: nothing is drawn behind a surface, and half a slab before one") {
  const VolumeItem v = item(grid(cube(9, -1, 1), [](Vec3) { return 1.0; }), one_color({1, 1, 1}), constant_opacity(1), 0.3);
  Frame opaque(1, 1);
  for (const double z : {1.5, 0.9, 0.13, -0.7, -3.0}) {
    opaque.depth[0] = float(100 - z);
    for (const Stack stack : {Stack::view, Stack::axis})
      CHECK(draw_layer(v, parallel_view(1, 1, 1), sliced(stack), &opaque).rgba[3] ==
            Approx(1 - std::exp(-std::clamp(1 - z, 0.0, 2.0))).epsilon(1e-4));
  }
}

TEST_CASE("slices: maximum, minimum, average and sum along axis-parallel rays are those of the samples") {
  const DatasetPtr d = grid(cube(9, 0, 8), [](Vec3 p) { return std::sin(1.7 * p.x + 3.1 * p.y) + 0.2 * p.z * std::cos(p.x * p.z); });
  double most = -HUGE_VAL, least = HUGE_VAL, sum = 0;
  for (int k = 0; k < 9; ++k) {
    const double f = std::sin(1.7 * 3 + 3.1 * 5) + 0.2 * k * std::cos(3.0 * k);
    most = std::max(most, f), least = std::min(least, f), sum += f * (k == 0 || k == 8 ? 0.5 : 1);
  }
  const auto shown = [&](RayFunction mode, Stack stack) {
    VolumeItem v = item(d, grey(-20, 20), constant_opacity(1), 1e-3);
    v.mode = mode;
    return double(draw_layer(v, parallel_view(1, 1, 1, {0, 0, -1}, {0, 1, 0}, {3, 5, 4}), sliced(stack)).rgba[0]) * 40 - 20;
  };
  for (const Stack stack : {Stack::view, Stack::axis}) {
    CHECK(shown(RayFunction::maximum, stack) == Approx(most).epsilon(0.01));
    CHECK(shown(RayFunction::minimum, stack) == Approx(least).epsilon(0.01));
    CHECK(std::abs(shown(RayFunction::sum, stack) - sum) < 0.1);  // a colour map of 256 steps over 40
    CHECK(std::abs(shown(RayFunction::average, stack) - sum / 8) < 0.1);
  }
}

TEST_CASE("slices: the same bytes from one thread and from eight") {
  const VolumeItem v = smooth_item(33, true);
  for (const Stack stack : {Stack::view, Stack::axis}) {
    set_thread_count(1);
    const auto one = draw_layer(v, some_views(130)[2], sliced(stack));
    set_thread_count(8);
    const auto eight = draw_layer(v, some_views(130)[2], sliced(stack));
    set_thread_count(0);
    CHECK(std::memcmp(one.rgba.data(), eight.rgba.data(), one.rgba.size() * 4) == 0);
  }
}

TEST_CASE("slices: what cannot be sliced is refused in words, and a flat or empty volume draws what there is") {
  VolumeItem v = smooth_item(9);
  const Projection p = parallel_view(4, 4, 1);
  v.mode = RayFunction::first_hit;
  CHECK(refused(v, p, sliced(), "method=ray"));
  v = smooth_item(9), v.light.shadows = 1;
  CHECK(refused(v, p, sliced(), "shadows"));
  v = smooth_item(9), v.detail.second = SecondAxis::gradient;
  CHECK(refused(v, p, sliced(), "two dimensions"));
  v = smooth_item(9), v.sampling.kernel = Kernel::bspline;
  CHECK(refused(v, p, sliced(), "bspline"));
  v = smooth_item(9), v.sampling.step = 1e-6;
  CHECK(refused(v, p, sliced(), "longer step"));
  UniformGrid g;
  g.dims = {5, 5, 1}, g.origin = {-1, -1, 0}, g.spacing = {0.5, 0.5, 0.25};
  v = item(grid(g, [](Vec3) { return 1.0; }), one_color({1, 1, 1}), constant_opacity(2));
  for (const Stack stack : {Stack::view, Stack::axis})
    CHECK(draw_layer(v, parallel_view(1, 1, 1, {0, 0, -1}, {0, 1, 0}, {0.1, 0.1, 0}), sliced(stack)).rgba[3] ==
          Approx(1 - std::exp(-0.5)).epsilon(1e-4));
}
