// SPDX-License-Identifier: Apache-2.0
// What a medium says about its own colours: integrators trust it.
#include <fmt/core.h>

#include "color/transfer_text.h"
#include "render/volume/medium/medium.h"
#include "render/volume/volume_support.h"
#include "render/volume/volume_truth.h"
#include "support/property.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("volume medium: over a change of the colour width a colour is a straight line to the accuracy, kinks and steep maps included") {
  for (const char* map : {"jet", "rainbow", "coolwarm", "sight", "gray"}) {
    INFO(map);
    ColorScale scale;
    scale.map = find_colormap(map), scale.lo = 0, scale.hi = 255;
    OpacityCurve curve;
    curve.points = {{0, 0}, {255, 0.5}};
    volume::Medium::Plan plan;
    plan.unit = 0.1, plan.lo = 0, plan.hi = 255;
    const volume::Medium medium(scale, curve, plan);
    // Eight nodes are as fine as it looks.
    const float least = 8 * 255.0f / float(volume::Medium::nodes), width = medium.color_width();
    REQUIRE(width > 0.99f * least);
    float worst = 0;
    for (float v = 0; v + width <= 255; v += 0.25f * width) {
      const Vec3f a = medium.color(v), b = medium.color(v + width), middle = medium.color(v + 0.5f * width);
      const Vec3f off = middle - 0.5f * (a + b);
      worst = std::max({worst, std::abs(off.x), std::abs(off.y), std::abs(off.z)});
    }
    // Twice the accuracy, and the 16 bits of the table and its nodes to either side; a kink of 0.035 per value within the finest width.
    CHECK(worst < (width > 1.01f * least ? 2 * plan.accuracy + 0.0005 : 0.25 * 0.035 * double(least) + 0.0005));
  }
}

TEST_CASE("volume medium: beside a step of colour each line has its own colour to its very end, on any scale") {
  for (const ScaleKind kind : {ScaleKind::linear, ScaleKind::log, ScaleKind::symlog})
    for (uint64_t seed = 1; seed <= 100; ++seed) {
      Random r(seed);
      ColorScale scale;
      parse_color_stops(fmt::format("0:red,{0}:red,{0}:blue,1:blue", r.in(0.05, 0.95)), scale, true);
      scale.kind = kind, scale.lo = r.in(0.1, 0.5), scale.hi = r.in(0.9, 40), scale.linear_threshold = r.in(0.02, 0.4);
      OpacityCurve curve;
      curve.points = {{scale.lo, 0.1}, {scale.hi, 0.5}};
      volume::Medium::Plan plan;
      plan.unit = 0.1, plan.lo = scale.lo, plan.hi = scale.hi;
      const volume::Medium medium(scale, curve, plan);
      for (size_t i = 0; i < medium.lines().size(); ++i) {
        const volume::Medium::Line& l = medium.lines()[i];
        const float lo = std::max(l.lo, float(scale.lo)), hi = std::min(l.hi, float(scale.hi));
        if (!(hi > lo)) continue;
        const Vec3f own = medium.color(lo + 0.5f * (hi - lo), int(i)), first = medium.color(lo, int(i)), last = medium.color(hi, int(i));
        CAPTURE(seed);
        CAPTURE(int(kind));
        CHECK(first.x == own.x);
        CHECK(last.x == own.x);
      }
    }
}

TEST_CASE("property: a medium has the colours of its scale to twice the accuracy that it is made for, however steep they are") {
  for (uint64_t seed : property_seeds(60)) {
    CAPTURE(seed);
    Random r(seed);
    ColorScale scale;
    std::string stops = "0:#000000";
    double at = 0;
    for (int i = r.whole(0, 3); i > 0; --i) {
      at += (1 - at) * r.magnitude(0.01, 0.8);
      stops += fmt::format(",{}:#{:06x}", at, r.whole(0, 0xffffff));
      // By a little or by much.
      if (r.chance(0.3)) stops += fmt::format(",{}:#{:06x}", at, r.whole(0, r.chance(0.5) ? 3 : 0xffffff));
    }
    parse_color_stops(stops + fmt::format(",1:#{:06x}", r.whole(0, 0xffffff)), scale, true);
    scale.kind = r.one_of({ScaleKind::linear, ScaleKind::linear, ScaleKind::log, ScaleKind::symlog});
    scale.lo = r.in(0.1, 0.5), scale.hi = r.in(0.9, 40), scale.linear_threshold = r.in(0.02, 0.4);
    OpacityCurve curve;
    curve.points = {{scale.lo, 0.1}, {scale.hi, 0.5}};
    volume::Medium::Plan plan;
    plan.unit = 0.1, plan.lo = scale.lo, plan.hi = scale.hi, plan.accuracy = r.one_of({1.0 / 2048, 1.0 / 16384});
    const volume::Medium medium(scale, curve, plan);
    const std::vector<double> knots = color_knots(scale);
    double worst = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto v = float(r.in(scale.lo, scale.hi));
      // Beside a knot floats tell the sides apart no better than this.
      const double air = 1e-6 * scale.hi;
      if (std::any_of(knots.begin(), knots.end(), [&](double k) { return std::abs(k - double(v)) < air; })) continue;
      const Vec4f c = scale.color(double(v));
      const Vec3f seen = medium.color(v);
      const double truth[3] = {srgb_decoded(double(c.x)), srgb_decoded(double(c.y)), srgb_decoded(double(c.z))};
      for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(double(seen[k]) - truth[k]));
    }
    // A plain table may have twice the accuracy wrong; 16 bits, and floats on the axis.
    CHECK(worst < 2 * plan.accuracy + 4e-5);
  }
}

// The place of a value on the scale rounds: it must not lie inside for the next value beyond an end.
TEST_CASE("property: a medium ends where its scale ends that draws nothing beyond, as sharply as floats tell") {
  for (const uint64_t seed : property_seeds(300)) {
    CAPTURE(seed);
    Random r(seed);
    ColorScale scale = one_color({1, 1, 1});
    scale.clamp = false;
    const double size = r.magnitude(1e-20, 1e20), lo = r.in(-1, 1) * size, hi = lo + r.in(0.1, 2) * size;
    scale.lo = lo + r.in(0.02, 0.3) * (hi - lo), scale.hi = hi - r.in(0.02, 0.3) * (hi - lo);
    scale.kind = r.chance(0.3) ? ScaleKind::symlog : ScaleKind::linear;
    OpacityCurve curve;
    const double opacity = r.in(0.1, 0.95);
    curve.points = {{lo, opacity}, {hi, opacity}};
    volume::Medium::Plan plan;
    plan.unit = 0.1, plan.lo = lo, plan.hi = hi;
    const volume::Medium medium(scale, curve, plan);
    const double inside = -std::log1p(-opacity) / plan.unit, air = 1e-6 * std::max(std::abs(lo), std::abs(hi));
    for (const double away : {1.0, 3.0, 10.0, 100.0}) {
      CHECK(medium.tau(float(scale.lo - away * air)) == 0);
      CHECK(medium.tau(float(scale.hi + away * air)) == 0);
      CHECK(medium.tau(float(scale.lo + away * air)) == doctest::Approx(inside).epsilon(1e-3));
      CHECK(medium.tau(float(scale.hi - away * air)) == doctest::Approx(inside).epsilon(1e-3));
    }
  }
}

TEST_CASE("volume medium: a spike up to opacity 1 keeps its integral, however few floats it is wide") {
  for (const double width : {0.003, 3e-4, 3e-5}) {
    constexpr double tip = 5.1281540402, unit = 0.0838913;
    OpacityCurve curve;
    curve.points = {{0, 0}, {tip - width, 0}, {tip, 1}, {tip + width, 0}};
    ColorScale scale = one_color({1, 1, 1});
    scale.lo = 0, scale.hi = 12.7;
    const volume::Medium medium(scale, curve,
                                {.unit = unit, .lo = 0, .hi = 12.7, .base = 0, .accuracy = 6e-5, .faint = 0.1, .most_tau = 3e6});
    // -ln(1 - o) has the integral 1 over a ramp from 0 to 1.
    double sum = 0;
    for (const volume::Medium::Line& l : medium.lines()) {
      const double a = std::max(double(l.lo), tip - 2 * width), b = std::min(double(l.hi), tip + 2 * width);
      for (int i = 0; i < 16 && a < b; ++i) sum += double(l(float(a + (b - a) * (i + 0.5) / 16))) * (b - a) / 16;
    }
    INFO(width);
    CHECK(sum == doctest::Approx(2 * width / unit).epsilon(4e-7 / width + 5e-5));  // floats are 5e-7 apart there
  }
}
