// SPDX-License-Identifier: Apache-2.0
#include "color/widgets/widget_regions.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "color/transfer_function.h"
#include "color/widgets/random_widgets.h"
#include "support/test.h"

using namespace sg;
using test::Random;

namespace {

struct Case {
  Vec2 lo, hi;
  double base;
  std::vector<TransferWidget> widgets;

  explicit Case(Random& random) {
    const Vec2 size{random.magnitude(1e-3, 1e6), random.magnitude(1e-3, 1e6)};
    lo = {random.in(-1, 1) * size.x, random.in(-1, 1) * size.y}, hi = lo + size;
    base = random.chance(0.5) ? 0 : std::round(random.in(-1, 1)) * size.x;
    for (int n = random.whole(1, 5); n > 0; --n) widgets.push_back(test::random_widget(random, lo, hi));
  }
  TransferFunction function(const OpacityCurve& factor = {{{0, 1}}}) const {
    ColorScale scale;
    scale.map = {"grey", MapKind::sequential, "", {{0, 0, 0}, {1, 1, 1}}};
    scale.lo = lo.x, scale.hi = hi.x;
    TransferDetail detail;
    detail.second = SecondAxis::gradient, detail.widgets = widgets, detail.second_factor = factor;
    return {scale, {{{0, 0}}}, detail, base};
  }
  float value(Random& random) const { return float(lo.x - base + (hi.x - lo.x) * random.in(-0.6, 1.6)); }
  float second(Random& random) const { return float(lo.y + (hi.y - lo.y) * random.in(-0.6, 1.6)); }
  // Rounding of floats, on either axis, in units of what opacity they turn.
  double rounding(const TransferWidget& w) const {
    const double size = std::max({std::abs(lo.x), std::abs(hi.x), std::abs(base)}), height = std::max(std::abs(lo.y), std::abs(hi.y));
    const double narrow = w.shape == TransferWidget::Shape::paint ? w.radius : 0.5 * (w.hi - w.lo);
    const double low = w.shape == TransferWidget::Shape::paint ? w.second_radius : 0.5 * (w.second_hi - w.second_lo);
    return 1e-6 * (1 + size / narrow + height / low);
  }
};

}  // namespace

TEST_CASE("property: widgets show what their definition says") {
  for (uint64_t seed : test::property_seeds(300)) {
    CAPTURE(seed);
    Random random(seed);
    const Case c(random);
    const TransferFunction f = c.function();
    for (int k = 0; k < 200; ++k) {
      float value = c.value(random), second = c.second(random);
      if (k % 2) {  // near what is drawn
        const TransferWidget& w = c.widgets[size_t(random.whole(0, int(c.widgets.size()) - 1))];
        value = float(random.in(w.lo, w.hi) - c.base), second = float(random.in(w.second_lo, w.second_hi));
      }
      double least = 0, most = 0;
      for (const TransferWidget& w : c.widgets) {
        const double truth = test::opacity_by_definition(w, double(value) + c.base, double(second)), off = c.rounding(w);
        // The top and the base of a rectangle, and the sides of a triangle next to its tip, are as sharp as the float of the place.
        bool sharp = false;
        if (!w.brushed()) {
          const double near = 1e-5 * (w.second_hi - w.second_lo) + 1e-6 * std::abs(double(second));
          sharp =
              std::abs(double(second) - w.second_lo) < 0.02 * (w.second_hi - w.second_lo) || std::abs(double(second) - w.second_hi) < near;
        }
        least = std::max(least, sharp ? 0 : truth - 60 * off), most = std::max(most, sharp ? w.opacity : truth + 60 * off);
      }
      const auto opacity = double(f.opacity(value, second));
      CHECK(opacity >= least - 1e-6);
      CHECK(opacity <= most + 1e-6);
      CHECK(double(f.at(value, second).opacity) == opacity);
    }
    CHECK(f.opacity(NAN, c.second(random)) == 0);
    CHECK(f.opacity(c.value(random), NAN) == 0);
  }
}

TEST_CASE("property: what is told of widgets over intervals is never wrong") {
  size_t clear = 0, drawn = 0;
  for (uint64_t seed : test::property_seeds(300)) {
    CAPTURE(seed);
    Random random(seed);
    const Case c(random);
    // A factor over the second axis has no say where there are widgets.
    const TransferFunction f = c.function(random.chance(0.3) ? OpacityCurve{{{0, 0}}} : OpacityCurve{{{0, 1}}});
    const OpacityCurve bound = bounding_curve(c.widgets);
    for (int k = 0; k < 40; ++k) {
      float lo = c.value(random), hi = c.value(random);
      const TransferWidget& w = c.widgets[size_t(random.whole(0, int(c.widgets.size()) - 1))];
      if (random.chance(0.3)) lo = float(w.hi - c.base);
      if (random.chance(0.3)) hi = float(w.lo - c.base);
      if (random.chance(0.5)) hi = lo + (hi - lo) * 0.05f;
      if (!(lo <= hi)) std::swap(lo, hi);
      float most = 0;
      for (int i = 0; i < 60; ++i) {
        const float value = i == 0 ? lo : i == 1 ? hi : std::clamp(float(random.in(double(lo), double(hi))), lo, hi);
        const float second = random.chance(0.5) ? c.second(random) : float(test::strongest(w, random).y);
        const float opacity = f.opacity(value, second);
        most = std::max(most, opacity);
        CHECK(double(opacity) <= bound.at(double(value) + c.base) + 60 * c.rounding(w) + 1e-5);
      }
      clear += f.clear(lo, hi), drawn += most > 0;
      if (f.clear(lo, hi)) CHECK(most == 0);
      double off = 0;
      for (const TransferWidget& each : c.widgets) off = std::max(off, c.rounding(each));
      CHECK(double(most) <= double(f.most_opacity(lo, hi)) + 10 * off);
    }
  }
  CHECK(clear > 1000);
  CHECK(drawn > 1000);
}

TEST_CASE("property: samples as near to each other as a widget is narrow do not miss it, on either axis") {
  size_t tried = 0;
  for (uint64_t seed : test::property_seeds(400)) {
    CAPTURE(seed);
    Random random(seed);
    const Case c(random);
    const TransferFunction f = c.function();
    for (const TransferWidget& w : c.widgets) {
      const Vec2 best = test::strongest(w, random);
      for (int axis = 0; axis < 2; ++axis) {
        const double from = axis == 0 ? w.lo - c.base : w.second_lo, to = axis == 0 ? w.hi - c.base : w.second_hi;
        const double narrow = double(axis == 0 ? f.narrow() : f.narrow_second());
        double apart = random.chance(0.5) ? narrow * 0.999 : (to - from) * random.magnitude(0.05, 1);
        const double begin = from - apart * (1 + random.unit());
        const auto lo = float(begin), hi = float(to + 2 * apart);
        if (axis == 0 ? f.misses(lo, hi, float(apart)) : f.misses_second(lo, hi, float(apart))) continue;
        apart *= 0.999;  // rounding
        float most = 0;
        for (double at = begin; at <= double(hi); at += apart)
          most = std::max(most, axis == 0 ? f.opacity(float(at), float(best.y)) : f.opacity(float(best.x - c.base), float(at)));
        CHECK(double(most) >= w.opacity * 0.49 - 120 * c.rounding(w));
        ++tried;
      }
    }
  }
  CHECK(tried > 500);
}

TEST_CASE("property: no widget is steeper behind its edges than they say") {
  for (uint64_t seed : test::property_seeds(300)) {
    CAPTURE(seed);
    Random random(seed);
    Case c(random);
    c.widgets.resize(1);
    const TransferWidget& w = c.widgets[0];
    const WidgetRegions regions(c.widgets, c.base);
    const double off = 60 * c.rounding(w) + 1e-6;
    const auto edges = regions.edges(), second_edges = regions.second_edges();
    REQUIRE(edges.size() == 2);
    REQUIRE(second_edges.size() == 2);
    for (int k = 0; k < 100; ++k) {
      const auto value = float(random.in(w.lo, w.hi) - c.base), second = float(random.in(w.second_lo, w.second_hi));
      const float opacity = regions.at(value, second, {}, nullptr);
      for (const auto& [all, at] : {std::pair{&edges, value}, std::pair{&second_edges, second}})
        for (const OpacityEdge& e : *all)
          if (std::isfinite(e.steep)) CHECK(double(opacity) <= double(e.steep) * double(std::abs(at - e.at)) + off);
    }
  }
}

TEST_CASE("widgets: an ellipse is full in its middle, gone on its border, and even all round") {
  TransferWidget w;
  w.shape = TransferWidget::Shape::ellipse;
  w.lo = 10, w.hi = 30, w.second_lo = 0, w.second_hi = 100, w.opacity = 0.8;
  const WidgetRegions f({w}, 0);
  const auto at = [&](double value, double second) { return double(f.at(float(value), float(second), {}, nullptr)); };
  CHECK(at(20, 50) == doctest::Approx(0.8));
  CHECK(at(25, 50) == doctest::Approx(0.8 * 0.5625));  // (1 - 1/4)^2
  for (double angle = 0; angle < 6.3; angle += 0.1) {
    CHECK(at(20 + 5 * std::cos(angle), 50 + 25 * std::sin(angle)) == doctest::Approx(0.8 * 0.5625).epsilon(1e-5));
    CHECK(at(20 + 10.001 * std::cos(angle), 50 + 50.005 * std::sin(angle)) == 0);
  }
  // No jump and no kink on the border.
  CHECK(at(29.9, 50) < 0.8 * 4e-4);
}

TEST_CASE("widgets: paint is a soft band round its line, and a dab is an ellipse") {
  const TransferWidget band = painted({{10, 0}, {30, 40}}, 2, 4, 1, {-1, -1, -1});
  CHECK(band.lo == 8);
  CHECK(band.hi == 32);
  CHECK(band.second_lo == -4);
  CHECK(band.second_hi == 44);
  const WidgetRegions f({band}, 0);
  // In radii the line runs from (0, 0) to (10, 10).
  for (const double t : {0.0, 1.0, 5.0, 9.9})
    for (const double d : {0.0, 0.25, 0.5, 0.9, 1.1})
      for (const double side : {1.0, -1.0}) {
        const double x = t - side * d / std::sqrt(2), y = t + side * d / std::sqrt(2), want = d < 1 ? (1 - d * d) * (1 - d * d) : 0;
        CHECK(double(f.at(float(10 + 2 * x), float(4 * y), {}, nullptr)) == doctest::Approx(want).epsilon(1e-4));
      }
  const TransferWidget dab = painted({{20, 50}}, 10, 50, 0.8, {-1, -1, -1});
  TransferWidget ellipse = dab;
  ellipse.shape = TransferWidget::Shape::ellipse;
  const WidgetRegions a({dab}, 0), b({ellipse}, 0);
  for (int i = 0; i < 50; ++i)
    for (int k = 0; k < 50; ++k) CHECK(a.at(float(i), 2.3f * float(k), {}, nullptr) == b.at(float(i), 2.3f * float(k), {}, nullptr));
}

TEST_CASE("widgets: the curve that bounds them is tight") {
  TransferWidget w;
  w.shape = TransferWidget::Shape::ellipse;
  w.lo = -1, w.hi = 1, w.opacity = 0.5;
  const OpacityCurve ellipse = bounding_curve({w}), band = bounding_curve({painted({{-3, 0}, {5, 1}}, 1, 1, 0.5, {})});
  for (int i = 0; i <= 200; ++i) {
    const double x = i / 200.0, exact = 0.5 * (1 - x * x) * (1 - x * x);
    for (const double most : {ellipse.at(x), ellipse.at(-x), band.at(-3 - x), band.at(5 + x)}) {
      CHECK(most >= exact - 1e-12);
      CHECK(most <= exact + 0.5 * 0.03);
    }
  }
  CHECK(band.at(1) == 0.5);
  CHECK(band.at(-4) == 0);
  CHECK(band.at(7) == 0);
}
