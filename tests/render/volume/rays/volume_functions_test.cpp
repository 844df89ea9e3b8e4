// SPDX-License-Identifier: Apache-2.0
// Ray functions, classification in steps, clipping, second fields: what each collects is known in closed form.
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;
using doctest::Approx;

namespace {

double bumpy(Vec3 p) { return std::sin(3 * p.x + 1) * std::cos(2.5 * p.y) + 0.7 * std::sin(4 * p.z + p.x * p.y); }

/// Grey over [lo, hi], always opaque.
VolumeItem scalar_item(DatasetPtr d, RayFunction mode, double lo, double hi) {
  VolumeItem v = item(std::move(d), grey(lo, hi), {{{lo, 1}, {hi, 1}}});
  v.mode = mode;
  return v;
}
double value_of(const Frame& f, double lo, double hi) { return lo + (hi - lo) * double(f.rgba[0]); }

}  // namespace

TEST_CASE("ray functions: maximum, minimum and average of axis-aligned rays through samples are those of the samples (V14)") {
  const size_t n = 17;
  const DatasetPtr d = grid(cube(n, -1, 1), bumpy);
  const View<float> v = d->fields()[0].array.view<float>();
  for (size_t i : {3u, 8u, 12u})
    for (size_t j : {2u, 9u}) {
      double most = -9, least = 9, mean = 0;
      for (size_t k = 0; k < n; ++k) {
        const double f = double(v[i + n * (j + n * k)]);
        most = std::max(most, f), least = std::min(least, f);
        mean += f * (k == 0 || k + 1 == n ? 0.5 : 1) / double(n - 1);  // the trapezoid rule is exact
      }
      const double x = -1 + 2 * double(i) / double(n - 1), y = -1 + 2 * double(j) / double(n - 1);
      CHECK(value_of(look(scene_of({scalar_item(d, RayFunction::maximum, -2, 2)}), x, y), -2, 2) == Approx(most).epsilon(2e-3));
      CHECK(value_of(look(scene_of({scalar_item(d, RayFunction::minimum, -2, 2)}), x, y), -2, 2) == Approx(least).epsilon(2e-3));
      CHECK(value_of(look(scene_of({scalar_item(d, RayFunction::average, -2, 2)}), x, y), -2, 2) == Approx(mean).epsilon(2e-3).scale(1));
      CHECK(value_of(look(scene_of({scalar_item(d, RayFunction::sum, -4, 4)}), x, y), -4, 4) == Approx(2 * mean).epsilon(2e-3).scale(1));
    }
}

TEST_CASE("ray functions: a linear field is met where its level lies; distance, length above it and picked depth follow") {
  // f = z on [-1, 1]; the ray comes from above.
  const DatasetPtr d = grid(cube(9, -1, 1), [](Vec3 p) { return p.z; });
  const Projection view = parallel_view(1, 1, 1, {0, 0, 1}, {0, 1, 0});  // looks up: enters at z = -1
  for (const double level : {-0.7, 0.13, 0.9}) {
    VolumeItem v = scalar_item(d, RayFunction::first_hit, -1, 1);
    v.levels = {level};
    const Frame f = draw(scene_of({v}), view);
    CHECK(double(f.depth[0]) == Approx(100 + level).epsilon(1e-6));
    CHECK(f.rgba[3] == 1);
    v = scalar_item(d, RayFunction::distance, 0, 2);
    v.levels = {level};
    CHECK(value_of(draw(scene_of({v}), view), 0, 2) == Approx(level + 1).epsilon(2e-3));
    v = scalar_item(d, RayFunction::accumulate, 0, 2);
    v.levels = {level};
    CHECK(value_of(draw(scene_of({v}), view), 0, 2) == Approx(1 - level).epsilon(2e-3));
  }
  VolumeItem none = scalar_item(d, RayFunction::first_hit, -1, 1);
  CHECK(error_of([&] { draw(scene_of({none}), view); }).find("levels=") != std::string::npos);
}

TEST_CASE("ray functions: isosurfaces lie where a sphere is, nearest first, each with the opacity of its value") {
  const DatasetPtr d = grid(cube(65, -1.2, 1.2), [](Vec3 p) { return length(p); });
  VolumeItem v = item(d, grey(0, 1), {{{0.4, 0.5}, {0.9, 0.25}}});
  v.mode = RayFunction::isosurface, v.levels = {0.4, 0.9};
  for (const double b : {0.02, 0.3, 0.6}) {
    const Frame f = look(scene_of({v}), b, 0.01);
    const double crossed = b < 0.4 ? 0.75 * 0.5 * 0.5 * 0.75 : 0.75 * 0.75;
    CHECK(1 - double(f.rgba[3]) == Approx(crossed).epsilon(1e-5));
  }
  v.levels = {0.9}, v.opacity.points = {{0, 1}};
  for (const double b : {0.02, 0.3, 0.6})
    CHECK(double(look(scene_of({v}), b, 0).depth[0]) == Approx(100 - std::sqrt(0.81 - b * b)).epsilon(2e-5));
}

TEST_CASE("ray functions: surfaces and extremes have the colour of another field, where they are") {
  // f = -|z - 0.2| is largest, and reaches -0.3, at places known; g = z.
  DatasetParts parts = grid(cube(21, -1, 1), [](Vec3 p) { return -std::abs(p.z - 0.2); })->parts();
  parts.fields.add({"g", Association::point, grid(cube(21, -1, 1), [](Vec3 p) { return p.z; })->fields()[0].array, "", Role::none});
  const DatasetPtr d = make_dataset(parts);
  const auto seen = [&](RayFunction mode) {
    VolumeItem v = scalar_item(d, mode, -2, 1);
    v.field = d->fields()[0].name, v.levels = {-0.3};
    v.detail.second = SecondAxis::field, v.detail.second_field = "g", v.detail.color_by_second = true, v.detail.second_color = grey(-1, 1);
    return value_of(look(scene_of({v}), 0.05, 0.03), -1, 1);
  };
  CHECK(seen(RayFunction::maximum) == Approx(0.2).epsilon(0.01));
  CHECK(seen(RayFunction::minimum) == Approx(-1).epsilon(0.01));
  CHECK(seen(RayFunction::first_hit) == Approx(0.5).epsilon(0.01));
  CHECK(seen(RayFunction::isosurface) == Approx(0.5).epsilon(0.01));
}

TEST_CASE("ray functions: the largest difference does not depend on where its rise is seen, and a later maximum shines through") {
  const auto at = [](double first, double second) {
    const DatasetPtr d = grid(cube(65, -1, 1), [=](Vec3 p) {
      const auto ball = [&](double z, double h) { return h * std::exp(-40 * ((p.z - z) * (p.z - z))); };
      return std::max(ball(0.5, first), ball(-0.5, second));
    });
    VolumeItem v = item(d, grey(0, 1), {{{0, 0}, {0.05, 0}, {1, 0.9}}});
    v.unit_distance = 0.2, v.mode = RayFunction::maximum_difference;
    return double(look(scene_of({v})).rgba[0]);
  };
  VolumeItem plain = item(grid(cube(5, 0, 1), [](Vec3) { return 0.0; }), grey(0, 1), {{{0, 0}}});
  plain.mode = RayFunction::maximum_difference;
  CHECK(look(scene_of({plain}), 0.5, 0.5).rgba[3] == 0);
  // A brighter layer behind a darker one: with compositing it is dimmed by what is in front, here hardly.
  CHECK(at(0.4, 1.0) > 0.6);
  CHECK(at(1.0, 0.4) > at(0.4, 1.0) - 0.3);
}

TEST_CASE("steps: pre-integrated classification is exact for a linear field at any step, post-classification only in the limit (V5)") {
  // f = z; a spike of the medium that steps of 0.3 miss.
  const DatasetPtr d = grid(cube(9, -1, 1), [](Vec3 p) { return p.z; });
  OpacityCurve spike;
  spike.points = {{-1, 0}, {0.10, 0}, {0.12, 0.9}, {0.14, 0}, {1, 0}};
  VolumeItem v = item(d, one_color({1, 1, 1}), spike);
  v.unit_distance = 0.02;
  // The optical depth: the integral of -log(1 - opacity)/unit over the spike, each side 0.02 wide.
  double depth = 0;
  for (int i = 0; i < 200000; ++i) depth += -std::log(1 - 0.9 * (i + 0.5) / 200000) / 200000 * 0.04 / 0.02;
  for (const double step : {0.3, 0.07, 0.011}) {
    INFO("step " << step);
    v.sampling.step = step, v.sampling.classify = VolumeClassify::integrated;
    CHECK(-std::log(1 - double(look(scene_of({v})).rgba[3])) == Approx(depth).epsilon(5e-3));
  }
  v.sampling.classify = VolumeClassify::post, v.sampling.step = 0.3;
  CHECK(std::abs(-std::log(1 - double(look(scene_of({v})).rgba[3]) + 1e-9) - depth) > 0.1);
  v.sampling.step = 0.0004;
  CHECK(-std::log(1 - double(look(scene_of({v})).rgba[3])) == Approx(depth).epsilon(2e-2));
}

TEST_CASE("steps: classified before interpolation, a spike between two samples is not seen, and samples on a spike are spread") {
  const DatasetPtr d = grid(cube(5, -1, 1), [](Vec3 p) { return p.z; });  // samples at multiples of 1/2
  VolumeItem v = item(d, one_color({1, 1, 1}), {{{-1, 0}, {0.1, 0}, {0.2, 0.5}, {0.3, 0}, {1, 0}}});
  v.sampling.step = 0.001, v.sampling.classify = VolumeClassify::pre;
  CHECK(look(scene_of({v})).rgba[3] == 0);
  v.opacity.points = {{-1, 0}, {-0.1, 0}, {0, 0.5}, {0.1, 0}, {1, 0}};
  // Opacity 1/2 at z = 0, falling linearly to 0 at +-1/2: depth = 2 * integral over half a cell of -log(1 - s/2) ds/2.
  double depth = 0;
  for (int i = 0; i < 100000; ++i) depth += -std::log(1 - 0.5 * (i + 0.5) / 100000) / 100000;
  CHECK(-std::log(1 - double(look(scene_of({v})).rgba[3])) == Approx(depth).epsilon(2e-3));
}

TEST_CASE("steps: jitter changes the picture of a coarse step, but not from one run or band of a picture to the next") {
  VolumeItem v = item(grid(cube(17, -1, 1), bumpy), grey(-1.7, 1.7), {{{-1.7, 0}, {0, 0}, {1.7, 0.9}}}, 0.3);
  const Projection view = parallel_view(24, 24, 14, {0.2, -0.4, -1});
  const Frame still = draw(scene_of({v}), view);
  v.sampling.jitter = true;
  const Frame a = draw(scene_of({v}), view), b = draw(scene_of({v}), view);
  CHECK(same_bytes(a, b));
  CHECK_FALSE(same_bytes(a, still));
  const Frame band = draw(scene_of({v}), band_of(view, 8, 8));
  CHECK(std::memcmp(&a.rgba[8 * 24 * 4], band.rgba.data(), 8 * 24 * 16) == 0);
}

TEST_CASE("volume: clip planes leave what lies on their side, exactly") {
  const DatasetPtr d = grid(cube(9, -1, 1), [](Vec3) { return 1.0; });
  VolumeItem v = item(d, one_color({1, 1, 1}), constant_opacity(2));
  v.clip = {{{0, 0, 1}, 0.3}, {{0, 0, -1}, 0.55}};
  CHECK(-std::log(1 - double(look(scene_of({v})).rgba[3])) == Approx(2 * 0.85).epsilon(1e-4));
  v.clip = {{{1, 0, 0}, -5}};
  CHECK(look(scene_of({v})).rgba[3] == 0);
}

TEST_CASE("volume: opacity by a second field and by the gradient are what their formulas say") {
  FieldSet fields;
  const UniformGrid g = cube(17, -1, 1);
  std::vector<double> a, b;
  for (size_t k = 0; k < 17; ++k)
    for (size_t j = 0; j < 17; ++j)
      for (size_t i = 0; i < 17; ++i) a.push_back(-1 + 0.125 * double(k)), b.push_back(-1 + 0.125 * double(i));
  fields.add({"f", Association::point, Array::from_vector(a), "", Role::scalars});
  fields.add({"g", Association::point, Array::from_vector(b), "", Role::none});
  VolumeItem v = item(make_dataset(g, fields), one_color({1, 1, 1}), constant_opacity(1));
  v.detail.second = SecondAxis::field, v.detail.second_field = "g";
  v.detail.second_factor.points = {{-1, 0}, {1, 1}};
  for (const double x : {-0.6, 0.1, 0.7}) {
    const double factor = 0.5 * (x + 1), tau = -std::log(1 - (1 - std::exp(-1.0)) * factor);
    CHECK(-std::log(1 - double(look(scene_of({v}), x, 0.3).rgba[3])) == Approx(2 * tau).epsilon(2e-3));
  }
  // |grad f| = 1: a factor that is 1/2 there.
  v.detail.second = SecondAxis::gradient;
  v.detail.second_factor.points = {{0, 0}, {2, 1}};
  CHECK(-std::log(1 - double(look(scene_of({v}), 0.1, 0.3).rgba[3])) ==
        Approx(-2 * std::log(1 - 0.5 * (1 - std::exp(-1.0)))).epsilon(2e-3));
}

TEST_CASE("volume: second derivative and curvature of a ball of larger values") {
  // f = 1 - r^2 / 2: H = -1, so n . H n = -1 and the mean curvature is 1/r.
  const DatasetPtr d = grid(cube(33, -1, 1), [](Vec3 p) { return 1 - 0.5 * dot(p, p); });
  VolumeItem v = item(d, one_color({1, 1, 1}), constant_opacity(1));
  v.detail.second = SecondAxis::second_derivative;
  v.detail.second_factor.points = {{-1.2, 1}, {-0.8, 1}, {-0.7, 0}};
  CHECK(-std::log(1 - double(look(scene_of({v}), 0.3, 0.4).rgba[3])) == Approx(2).epsilon(2e-2));
  v.detail.second = SecondAxis::curvature;
  v.detail.second_factor.points = {{1.9, 0}, {2, 1}};  // r < 1/2
  CHECK(-std::log(1 - double(look(scene_of({v}), 0.2, 0.1).rgba[3])) == Approx(2 * std::sqrt(0.25 - 0.05)).epsilon(5e-2));
}

TEST_CASE("volume: packets of any width and single rays integrate to the same bytes, and to the general way within rounding") {
  for (const bool shaded : {false, true})
    for (const ElementType type : {ElementType::f32, ElementType::u8, ElementType::i16}) {
      VolumeItem v = item(grid(
                              cube(21, -1, 1), [](Vec3 p) { return 100 + 50 * bumpy(p); }, type),
                          grey(15, 185), {{{15, 0}, {90, 0}, {185, 0.9}}});
      v.unit_distance = 0.1, v.shaded = shaded;
      const Projection view = perspective_view(30, 30, 34, {1.9, 1.4, 2.6}, {0, 0, 0});
      volume::Knobs single;
      single.simd = false;
      const Frame a = draw(scene_of({v}), view), b = draw(scene_of({v}), view, single);
      CHECK(same_bytes(a, b));
      v.clip = {{{1, 0, 0}, 1e6}};                                           // packets do not know planes
      CHECK(largest_difference(a, draw(scene_of({v}), view)) < 2.0f / 512);  // each within 1/512 of the truth
      v.clip.clear();
      set_thread_count(1);
      const Frame one = draw(scene_of({v}), view);
      set_thread_count(8);
      CHECK(same_bytes(one, draw(scene_of({v}), view)));
      set_thread_count(0);
    }
}

TEST_CASE("volume: skipping and early ends are not seen within the tolerance") {
  VolumeItem v = item(grid(cube(49, -1, 1), bumpy), grey(-1.7, 1.7), {{{-1.7, 0}, {0.6, 0}, {1.7, 0.95}}});
  v.unit_distance = 0.05;
  const Projection view = perspective_view(40, 40, 46, {1.9, 1.4, 2.6}, {0, 0, 0});
  volume::Knobs no_skip, no_end;
  no_skip.skip_empty = false, no_end.stop_below = 0;
  const Frame a = draw(scene_of({v}), view);
  CHECK(largest_difference(a, draw(scene_of({v}), view, no_skip)) < 1.0f / 512);  // strides begin elsewhere
  CHECK(largest_difference(a, draw(scene_of({v}), view, no_end)) < 0.3f / 512);
  CHECK_FALSE(same_bytes(a, draw(scene_of({v}), view, no_end)));
}

TEST_CASE("volume: infinite and missing values neither hang nor spread: elsewhere the picture stays") {
  const auto f = [](Vec3 p) { return p.x > 0.4 && p.y > 0.4 ? (p.z > 0 ? HUGE_VAL : -HUGE_VAL) : p.x < -0.7 ? NAN : bumpy(p); };
  const DatasetPtr broken = grid(cube(17, -1, 1), f), whole = grid(cube(17, -1, 1), bumpy);
  for (const double step : {0.0, 0.03})
    for (const bool shaded : {false, true}) {
      VolumeItem a = item(broken, grey(-1.7, 1.7), {{{-1.7, 0}, {0, 0.1}, {1.7, 0.9}}}, step), b = a;
      a.shaded = b.shaded = shaded, b.data = whole;
      // A column of rays that meets sound cells only, away from the differences that shading takes.
      for (const double y : {-0.6, 0.013}) {
        const Frame p = look(scene_of({a}), 0.1, y), q = look(scene_of({b}), 0.1, y);
        CHECK(largest_difference(p, q) < (step > 0 ? 2e-4f : 2.0f / 512));
      }
      const Frame all = draw(scene_of({a}), perspective_view(20, 20, 24, {1.9, 1.4, 2.6}, {0, 0, 0}));
      for (float c : all.rgba) REQUIRE(c == c);
    }
}

TEST_CASE("ray functions: the sum through ellipsoids of constant density is that of their chords, with order 1 at their edges (V9)") {
  struct Ellipsoid {
    Vec3 center, axes;
    double density;
  };
  const Ellipsoid phantom[] = {
      {{0, 0, 0}, {0.7, 0.9, 0.8}, 1}, {{0.2, 0.1, 0}, {0.25, 0.4, 0.3}, -0.4}, {{-0.3, -0.2, 0.1}, {0.15, 0.3, 0.2}, 0.6}};
  const auto density = [&](Vec3 p) {
    double sum = 0;
    for (const Ellipsoid& e : phantom) {
      const Vec3 d{(p.x - e.center.x) / e.axes.x, (p.y - e.center.y) / e.axes.y, (p.z - e.center.z) / e.axes.z};
      if (dot(d, d) < 1) sum += e.density;
    }
    return sum;
  };
  const auto chords = [&](double x, double y) {
    double sum = 0;
    for (const Ellipsoid& e : phantom) {
      const double u = (x - e.center.x) / e.axes.x, v = (y - e.center.y) / e.axes.y, rest = 1 - u * u - v * v;
      if (rest > 0) sum += e.density * 2 * e.axes.z * std::sqrt(rest);
    }
    return sum;
  };
  const auto rms = [&](size_t n) {
    VolumeItem v = scalar_item(grid(cube(n, -1, 1), density), RayFunction::sum, 0, 2.5);
    const Projection view = parallel_view(41, 41, 21, {0, 0, -1});
    const Frame f = draw(scene_of({v}), view);
    double sum = 0;
    for (int y = 0; y < 41; ++y)
      for (int x = 0; x < 41; ++x) {
        const auto ray = view.ray(x + 0.5, y + 0.5);
        if (std::abs(ray.origin.x) >= 1 || std::abs(ray.origin.y) >= 1) continue;
        const double d = 2.5 * double(f.rgba[size_t(4 * (41 * y + x))]) - chords(ray.origin.x, ray.origin.y);
        sum += d * d;
      }
    return std::sqrt(sum / (41 * 41));
  };
  const double coarse = rms(17), middle = rms(33), fine = rms(65);
  INFO(coarse << " " << middle << " " << fine);
  CHECK(fine < 0.02);
  CHECK(std::log2(coarse / fine) / 2 > 0.8);
  CHECK(std::log2(coarse / fine) / 2 < 1.7);
}
