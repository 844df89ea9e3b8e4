// SPDX-License-Identifier: Apache-2.0
// The ray integral against its closed forms.
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;
using doctest::Approx;

TEST_CASE("volume: a constant medium is exact for any step") {
  const DatasetPtr d = grid(cube(9, -0.75, 0.75), [](Vec3) { return 1.0; });
  for (const double step : {0.0, 0.1, 0.37, 0.75, 1.4999999, 1.5, 7.0, 0.0011}) {
    const Frame f = look(scene_of({item(d, one_color({0.8f, 0.4f, 0.2f}), constant_opacity(2), step)}));
    INFO("step " << step);
    CHECK(f.rgba[0] == Approx(0.76017035).epsilon(2e-6 + (step == 0.0011 ? 1e-4 : 0)));
    CHECK(f.rgba[1] == Approx(0.5 * 0.76017035).epsilon(1e-4));
    CHECK(1 - f.rgba[3] == Approx(0.04978707).epsilon(1e-4));
  }
}

TEST_CASE("volume: opacity .3 per unit becomes .0853 over a quarter, and four quarters make it .3 again") {
  OpacityCurve curve;
  curve.points = {{0, 0.3}};
  UniformGrid g = cube(5, -0.125, 0.125);
  CHECK(look(scene_of({item(grid(g, [](Vec3) { return 0.5; }), one_color({1, 1, 1}), curve, 0.25)})).rgba[3] == Approx(0.08530878));
  g = cube(5, -0.5, 0.5);
  CHECK(look(scene_of({item(grid(g, [](Vec3) { return 0.5; }), one_color({1, 1, 1}), curve, 0.25)})).rgba[3] == Approx(0.3));
}

// tau = -ln(1 - opacity) is no straight line over the value, nor is the value one along the diagonal of a face: 1.7 s (1 - s).
TEST_CASE("volume: a dense ramp of opacity over a value that turns is within the tolerance") {
  UniformGrid g;
  g.dims = {2, 2, 2}, g.spacing = {1, 1, 1}, g.origin = {0, 0, 0};
  const DatasetPtr d = grid(g, [](Vec3 p) { return p.x > p.y ? 1 : p.x < p.y ? 0.7 : 0; });
  for (const double steep : {0.2, 0.3, 0.4, 0.6})
    for (const double unit : {3.0, 1.0, 0.3, 0.1}) {
      OpacityCurve curve;
      curve.points = {{-0.25, 0}, {1.25, 1.5 * steep}};  // no knot on the way
      VolumeItem v = item(d, one_color({1, 1, 1}), curve);
      v.unit_distance = unit, v.shaded = false;
      double depth = 0;
      constexpr int n = 20000;
      for (int i = 0; i < n; ++i) {
        const double s = (i + 0.5) / n;
        depth -= std::log1p(-(1.7 * s * (1 - s) + 0.25) * steep) / n;
      }
      depth *= std::sqrt(2.0) / unit;
      Projection view = parallel_view(1, 1, 1, normalize(Vec3{1, 1, 0}), {0, 0, 1}, {0.5, 0.5, 0.5});
      view.eye = Vec3{0.5, 0.5, 0.5} - view.forward * 4, view.far_plane = 10;
      for (const double tolerance : {1.0 / 64, 1.0 / 512, 1.0 / 4096}) {
        v.sampling.tolerance = tolerance;
        INFO("opacity " << steep << " (v + 1/4), unit " << unit << ", tolerance " << tolerance);
        CHECK(std::abs(draw(scene_of({v}), view).rgba[3] + std::expm1(-depth)) < tolerance);
        CHECK(std::abs(draw(scene_of({v}), view, {}, by_single_rays(view)).rgba[3] + std::expm1(-depth)) < tolerance);
      }
    }
}

TEST_CASE("volume: exp and log of our own agree with the library's") {
  for (int i = 0; i < 2000; ++i) {
    const double x = random_unit(1, uint64_t(i)) * (i % 2 ? 1 : 50);
    REQUIRE(volume::exp_negative(x) == Approx(std::exp(-x)).epsilon(1e-14));
    const double y = i % 3 ? random_unit(2, uint64_t(i)) : std::pow(10, -16 * random_unit(2, uint64_t(i)));
    REQUIRE(volume::minus_log_one_minus(y) == Approx(-std::log1p(-y)).epsilon(1e-13));
  }
  CHECK(volume::exp_negative(0) == 1);
  CHECK(volume::exp_negative(1e30) == 0);
  CHECK(volume::minus_log_one_minus(0) == 0);
}

TEST_CASE("volume: front to back equals back to front on random segments") {
  for (uint64_t trial = 0; trial < 200; ++trial) {
    Gathered front;
    float back[4] = {0, 0, 0, 0}, segments[40][4];
    for (uint64_t i = 0; i < 40; ++i) {
      const float alpha = float(random_unit(trial, 4 * i)) * 0.4f;
      for (uint64_t c = 0; c < 3; ++c) segments[i][c] = alpha * float(random_unit(trial, 4 * i + 1 + c));
      segments[i][3] = alpha;
      front.behind(segments[i]);
    }
    for (int i = 40; i-- > 0;)
      for (int c = 0; c < 4; ++c) back[c] = segments[i][c] + (1 - segments[i][3]) * back[c];
    REQUIRE(std::abs(front.r - back[0]) < 1e-6);
    REQUIRE(std::abs(front.b - back[2]) < 1e-6);
    REQUIRE(std::abs(1 - front.transmittance - back[3]) < 1e-6);
  }
}

TEST_CASE("volume: a sphere of constant density darkens by exp(-2 sigma sqrt(R^2-b^2)), order 2 away from the rim") {
  // The field is the signed distance to the sphere; density jumps from sigma to zero at its surface.
  const double sigma = 1.2, radius = 1;
  double h[3], error[3];
  for (int level = 0; level < 3; ++level) {
    const size_t n = size_t(12) << level;
    const DatasetPtr d = grid(cube(n + 1, -1.3, 1.3), [&](Vec3 p) { return length(p) - radius; });
    OpacityCurve curve;
    curve.points = {{-10, 1 - std::exp(-sigma)}, {0, 1 - std::exp(-sigma)}, {1e-9, 0}, {10, 0}};
    // The step is far below a cell, so that the error is that of the grid.
    const Frame f = draw(scene_of({item(d, one_color({1, 1, 1}), curve, 2e-4)}), parallel_view(12, 12, 12 / 1.3, {0.3, -0.2, -1}));
    double sum = 0;
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 12; ++x) {
        const double b = std::hypot(x - 5.5, y - 5.5) * 1.3 / 12;
        if (b > 0.7) continue;
        const double want = std::exp(-2 * sigma * std::sqrt(radius * radius - b * b));
        sum = std::max(sum, std::abs(1 - double(f.rgba[size_t(4 * (12 * y + x) + 3)]) - want));
      }
    h[level] = 1.0 / double(n), error[level] = sum;
  }
  const double order = observed_order(h, error, 3);
  INFO("errors " << error[0] << " " << error[1] << " " << error[2]);
  CHECK(order > 1.6);
  CHECK(order < 2.4);
  CHECK(error[2] < 1e-3);
}

TEST_CASE("volume: midpoint steps through a linear ramp of density converge with order 2") {
  const DatasetPtr d = grid(cube(3, 0, 1), [](Vec3 p) { return 3 * p.z * p.z; });  // two cells: linear in each
  double h[3], error[3];
  // integral of the piecewise linear interpolant of 3 z^2 with knots 0, .5, 1: .5*(0+.75)/2 + .5*(.75+3)/2
  const double want = std::exp(-(0.25 * 0.75 + 0.25 * 3.75));
  for (int i = 0; i < 3; ++i) {
    h[i] = 0.21 / double(1 << i);
    error[i] =
        std::abs(1 - double(look(scene_of({item(d, one_color({1, 1, 1}), density_is_value(0, 3, 20000), h[i])}), 0.4, 0.4).rgba[3]) - want);
  }
  INFO("errors " << error[0] << " " << error[1] << " " << error[2]);
  CHECK(observed_order(h, error, 3) > 1.4);  // the knot falls into a step now here, now there
  CHECK(error[2] < 1e-3);
}

TEST_CASE("volume: the projection of a Gaussian ball is s sqrt(2 pi) exp(-b^2 / 2 s^2)") {
  const double s = 0.3;
  const DatasetPtr d = grid(cube(97, -1.8, 1.8), [&](Vec3 p) { return std::exp(-dot(p, p) / (2 * s * s)); });
  for (const double b : {0.0, 0.2, 0.5}) {
    const Frame f = look(scene_of({item(d, one_color({1, 1, 1}), density_is_value(0, 1, 20000), 0.004)}), b, 0);
    CHECK(-std::log(1 - double(f.rgba[3])) == Approx(s * std::sqrt(2 * M_PI) * std::exp(-b * b / (2 * s * s))).epsilon(2e-3));
  }
}

TEST_CASE("volume: two overlapping homogeneous media add their densities and mix by them") {
  const auto at = [](double lo, double hi) {
    UniformGrid g;
    g.dims = {5, 5, 9}, g.origin = {-1, -1, lo}, g.spacing = {0.5, 0.5, (hi - lo) / 8};
    return grid(g, [](Vec3) { return 1.0; });
  };
  for (const double step : {0.0, 0.3, 0.01}) {
    const double ta = 0.7, tb = 1.9;
    // Seen from +z: a alone for z in (.5, 1), both in (-.25, .5), b alone in (-1, -.25).
    const Scene scene = scene_of({item(at(-0.25, 1), one_color({1, 0, 0}), constant_opacity(ta), step),
                                  item(at(-1, 0.5), one_color({0, 1, 0}), constant_opacity(tb), step)});
    const Frame f = look(scene);
    const double t1 = std::exp(-0.5 * ta), t2 = std::exp(-0.75 * (ta + tb)), t3 = std::exp(-0.75 * tb);
    INFO("step " << step);
    CHECK(1 - f.rgba[3] == Approx(t1 * t2 * t3).epsilon(1e-4));
    CHECK(f.rgba[0] == Approx((1 - t1) + t1 * (1 - t2) * ta / (ta + tb)).epsilon(1e-4));
    CHECK(f.rgba[1] == Approx(t1 * (1 - t2) * tb / (ta + tb) + t1 * t2 * (1 - t3)).epsilon(1e-4));
  }
}

TEST_CASE("volume: a translucent sheet inside is mixed in at its depth") {
  const DatasetPtr d = grid(cube(9, -1, 1), [](Vec3) { return 1.0; });
  const double tau = 0.9;
  for (const double z : {0.63, -0.2, 2.0, -2.0}) {  // inside, inside, before, behind
    FragmentLists sheet;
    sheet.start = {0, 1};
    sheet.fragments = {{float(100 - z), {0, 0.3f, 0, 0.4f}, 7}};
    for (const double step : {0.0, 0.31}) {
      const Frame f = look(scene_of({item(d, one_color({1, 0, 0}), constant_opacity(tau), step)}), 0, 0, {}, sheet);
      const double before = std::exp(-tau * std::clamp(1 - z, 0.0, 2.0)), after = std::exp(-tau * std::clamp(z + 1, 0.0, 2.0));
      CHECK(f.rgba[0] == Approx((1 - before) + before * 0.6 * (1 - after)).epsilon(1e-4));
      CHECK(f.rgba[1] == Approx(before * 0.3).epsilon(1e-4));
      CHECK(1 - f.rgba[3] == Approx(before * 0.6 * after).epsilon(1e-4));
    }
  }
}

TEST_CASE("volume: an opaque surface inside stops the ray at its depth") {
  const DatasetPtr d = grid(cube(9, -1, 1), [](Vec3) { return 1.0; });
  const double tau = 1.1;
  for (const double z : {0.9, 0.123, -0.77, 3.0}) {
    for (const double step : {0.0, 0.4}) {
      const Projection p = parallel_view(1, 1, 1);
      Frame f(1, 1);
      f.depth[0] = float(100 - z), f.ids[0] = 9;
      f.rgba = {0, 0, 0.5f, 1};
      Context context;
      composite_volumes(scene_of({item(d, one_color({1, 0, 0}), constant_opacity(tau), step)}), p, {}, f, context);
      const double pass = std::exp(-tau * std::clamp(1 - z, 0.0, 2.0));
      CHECK(f.rgba[0] == Approx(1 - pass).epsilon(1e-4));
      CHECK(f.rgba[2] == Approx(0.5 * pass).epsilon(1e-4));
      CHECK(f.rgba[3] == 1);
      CHECK(f.ids[0] == 9);
    }
  }
}

TEST_CASE("volume: in perspective the ray stops at eye depth, not at distance") {
  const DatasetPtr d = grid(cube(9, -1, 1), [](Vec3) { return 1.0; });
  const Projection p = perspective_view(9, 9, 12, {0, 0, 3}, {0, 0, 0});
  Frame f(9, 9);
  std::fill(f.depth.begin(), f.depth.end(), 2.75f);  // the plane z = .25
  Context context;
  composite_volumes(scene_of({item(d, one_color({1, 1, 1}), constant_opacity(1))}), p, {}, f, context);
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 9; ++x) {
      // Enters by the face z = 1 at depth 2 where |x| <= 1 there, else it enters by a side or misses.
      const double sx = (x - 4) / 12.0, sy = (y - 4) / 12.0;
      if (std::max(std::abs(sx), std::abs(sy)) * 2.75 > 1) continue;
      const double per_depth = std::sqrt(1 + sx * sx + sy * sy);
      REQUIRE(-std::log(1 - f.rgba[size_t(4 * (9 * y + x) + 3)]) == Approx(0.75 * per_depth).epsilon(1e-4));
    }
}

TEST_CASE("volume: a picture without volumes gets its fragments, and a wrong list is refused") {
  FragmentLists lists;
  lists.start = {0, 2, 2};
  lists.fragments = {{1, {0.5f, 0, 0, 0.5f}, 1}, {2, {0, 0.25f, 0, 0.25f}, 2}};
  Frame f(2, 1);
  f.rgba = {0, 0, 1, 1, 0.1f, 0.2f, 0.3f, 1};
  Context context;
  composite_volumes(Scene{}, parallel_view(2, 1, 1), lists, f, context);
  CHECK(f.rgba[0] == Approx(0.5));
  CHECK(f.rgba[1] == Approx(0.125));
  CHECK(f.rgba[2] == Approx(0.375));
  CHECK(f.rgba[3] == 1);
  CHECK(f.rgba[5] == 0.2f);
  lists.start = {0, 2};
  CHECK(error_of([&] { composite_volumes(Scene{}, parallel_view(2, 1, 1), lists, f, context); }).find("2 x 1") != std::string::npos);
  CHECK(error_of([&] { composite_volumes(Scene{}, parallel_view(3, 1, 1), {}, f, context); }).find("2 x 1") != std::string::npos);
}
