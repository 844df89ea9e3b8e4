// SPDX-License-Identifier: Apache-2.0
#include "color/transfer_function.h"

#include "color/cie.h"
#include "support/test.h"

using namespace sg;

namespace {

ColorScale grey(double lo, double hi) {
  ColorScale s;
  s.map = {"grey", MapKind::sequential, "", {{0, 0, 0}, {1, 1, 1}}};
  s.lo = lo, s.hi = hi;
  return s;
}

const OpacityCurve ramp{{{0, 0}, {0.25, 0}, {0.5, 0.8}, {0.5, 0.2}, {1, 0.6}}};

// A smooth field's derivatives by central differences.
template <class F>
void derivatives(F&& f, Vec3 p, Vec3f& g, SecondDerivatives& h) {
  const double e = 1e-3;
  const auto at = [&](double x, double y, double z) { return f(Vec3{p.x + x * e, p.y + y * e, p.z + z * e}); };
  g = Vec3f(Vec3{at(1, 0, 0) - at(-1, 0, 0), at(0, 1, 0) - at(0, -1, 0), at(0, 0, 1) - at(0, 0, -1)} * (0.5 / e));
  const double c = at(0, 0, 0), s = 1 / (e * e);
  h.xx = float((at(1, 0, 0) + at(-1, 0, 0) - 2 * c) * s), h.yy = float((at(0, 1, 0) + at(0, -1, 0) - 2 * c) * s);
  h.zz = float((at(0, 0, 1) + at(0, 0, -1) - 2 * c) * s);
  h.xy = float((at(1, 1, 0) + at(-1, -1, 0) - at(1, -1, 0) - at(-1, 1, 0)) * s / 4);
  h.xz = float((at(1, 0, 1) + at(-1, 0, -1) - at(1, 0, -1) - at(-1, 0, 1)) * s / 4);
  h.yz = float((at(0, 1, 1) + at(0, -1, -1) - at(0, 1, -1) - at(0, -1, 1)) * s / 4);
}

}  // namespace

TEST_CASE("transfer function: a fast curve is the curve, steps and ends included") {
  for (const double base : {0.0, 1000.0}) {
    OpacityCurve moved = ramp;
    for (Vec2& p : moved.points) p.x += base;
    const FastCurve fast(moved, base);
    for (int i = -300; i <= 1300; ++i) {
      const float x = float(i) / 1024;  // exact
      CHECK(fast.at(x) == doctest::Approx(ramp.at(double(x))).epsilon(1e-6));
    }
    CHECK(fast.at(0.5f) == 0.2f);
    CHECK(fast.at(std::nextafter(0.5f, 0.0f)) == doctest::Approx(0.8).epsilon(1e-5));
    CHECK(fast.at(NAN) == 0);
  }
  const FastCurve constant({{{7, 0.3}}}, 0);
  CHECK(constant.at(-1) == 0.3f);
  CHECK(constant.at(9) == 0.3f);
  CHECK_FALSE(constant.zero(0, 1));
}

TEST_CASE("transfer function: nothing that is clear draws, and what is far from anything is clear") {
  TransferDetail detail;
  std::vector<TransferFunction> functions;
  functions.emplace_back(grey(0, 1), ramp, detail);
  detail.second = SecondAxis::gradient;
  detail.second_factor.points = {{0, 0}, {2, 1}};
  functions.emplace_back(grey(0, 1), ramp, detail);
  detail.widgets = {{TransferWidget::Shape::triangle, 0.3, 0.5, 0, 2, 0.7, {1, 0, 0}},
                    {TransferWidget::Shape::rectangle, 0.7, 0.8, 1, 3, 0.4, {-1, -1, -1}}};
  functions.emplace_back(grey(0, 1), ramp, detail);
  ColorScale cut = grey(0.1, 0.6);
  cut.clamp = false;
  functions.emplace_back(cut, ramp, TransferDetail{});
  size_t clear = 0;
  for (const TransferFunction& f : functions)
    for (int a = -4; a <= 44; ++a)
      for (int b = a; b <= 44; ++b) {
        const float lo = float(a) / 40, hi = float(b) / 40;
        float most = 0;
        for (int k = 0; k <= 20; ++k)
          for (const float second : {-1.0f, 0.0f, 0.5f, 1.0f, 1.999f, 2.5f, 10.0f}) {
            const float value = lo + (hi - lo) * float(k) / 20, opacity = f.opacity(value, second);
            most = std::max(most, opacity);
            if (k == 7) CHECK(f.at(value, second).opacity == opacity);
          }
        clear += f.clear(lo, hi);
        if (f.clear(lo, hi)) CHECK(most == 0);
        CHECK(most <= f.most_opacity(lo, hi) * 1.00001f);
      }
  CHECK(clear > 100);
  CHECK(functions[0].clear(-1, 0.24f));
  CHECK_FALSE(functions[0].clear(0.2f, 0.26f));
  CHECK(functions[2].clear(0.5f, 0.7f));
  CHECK(functions[3].clear(0.61f, 5));
}

TEST_CASE("transfer function: a second axis multiplies, colours are in linear light") {
  TransferDetail detail;
  detail.second = SecondAxis::gradient;
  detail.second_factor.points = {{0, 0}, {4, 1}};
  const TransferFunction f(grey(0, 1), ramp, detail);
  CHECK(f.at(0.75f, 1).opacity == doctest::Approx(0.25 * 0.4));
  CHECK(f.at(0.75f, 9).opacity == doctest::Approx(0.4));
  CHECK(f.at(0.75f, NAN).opacity == 0);
  CHECK(f.at(NAN, 1).opacity == 0);
  CHECK(f.at(0.75f, 1).g == doctest::Approx(srgb_to_linear(0.75)).epsilon(2e-3));
  // With a base, values are stored ones plus it.
  OpacityCurve far = ramp;
  for (Vec2& p : far.points) p.x += 1e6;
  const TransferFunction moved(grey(1e6, 1e6 + 1), far, detail, 1e6);
  for (const float v : {0.1f, 0.4f, 0.6f, 0.9f}) {
    CHECK(moved.at(v, 2).opacity == doctest::Approx(f.at(v, 2).opacity));
    CHECK(moved.at(v, 2).r == doctest::Approx(f.at(v, 2).r));
  }
}

TEST_CASE("transfer function: colours of log and symlog scales are those of the scale") {
  for (const ScaleKind kind : {ScaleKind::linear, ScaleKind::log, ScaleKind::symlog}) {
    ColorScale s = grey(kind == ScaleKind::symlog ? -1000 : 0.01, 1000);
    s.kind = kind, s.linear_threshold = 1;
    s.above = Vec3f{1, 0, 0};
    const TransferFunction f(s, {{{0, 1}}}, {});
    for (const double v : {0.011, 0.5, 1.0, 37.0, 512.0, 999.0}) {
      const float want = float(srgb_to_linear(double(s.color(v).x)));
      CHECK(f.at(float(v), 0).r == doctest::Approx(want).epsilon(0.01));
    }
    CHECK(f.at(1001, 0).r == 1);
    CHECK(f.at(1001, 0).g == 0);
  }
}

TEST_CASE("transfer function: widgets are full in their middle, gone at their sides, and mix their colours where they overlap") {
  TransferDetail detail;
  detail.second = SecondAxis::gradient;
  detail.widgets = {{TransferWidget::Shape::triangle, 10, 20, 0, 100, 0.8, {1, 0, 0}}};
  const TransferFunction t(grey(0, 100), {{{0, 0}}}, detail);
  CHECK(t.at(15, 50).opacity == doctest::Approx(0.8));
  CHECK(t.at(15, 50).r == 1);
  CHECK(t.at(15, 50).g == 0);
  CHECK(t.at(12.5f, 100).opacity == doctest::Approx(0.4));  // half of the way at full width
  CHECK(t.at(12.5f, 50).opacity == doctest::Approx(0));     // the side at half height
  CHECK(t.at(15, 101).opacity == 0);
  CHECK(t.at(15, -1).opacity == 0);
  detail.widgets.push_back({TransferWidget::Shape::rectangle, 10, 20, 0, 100, 0.8, {0, 0, 1}});
  const TransferFunction both(grey(0, 100), {{{0, 0}}}, detail);
  const auto s = both.at(15, 100);
  CHECK(s.opacity == doctest::Approx(0.8));
  CHECK(s.r == doctest::Approx(0.5));
  CHECK(s.b == doctest::Approx(0.5));
  detail.widgets = {{TransferWidget::Shape::rectangle, 10, 20, 0, 100, 1, {-1, -1, -1}}};
  CHECK(TransferFunction(grey(0, 100), {{{0, 0}}}, detail).at(15, 5).g == doctest::Approx(srgb_to_linear(0.15)).epsilon(0.02));
}

TEST_CASE("transfer function: colour by another field, opacity by the value") {
  TransferDetail detail;
  detail.second = SecondAxis::field, detail.second_field = "T";
  detail.color_by_second = true;
  detail.second_color = grey(0, 10);
  const TransferFunction f(grey(0, 1), ramp, detail);
  CHECK(f.at(0.75f, 10).opacity == doctest::Approx(0.4));
  CHECK(f.at(0.75f, 10).r == doctest::Approx(1).epsilon(1e-3));
  CHECK(f.at(0.75f, 0).r == doctest::Approx(0).epsilon(1e-3));
  CHECK(f.at(0.75f, NAN).r == doctest::Approx(srgb_to_linear(0.6)).epsilon(1e-3));  // the colour of no value
  detail.second = SecondAxis::none;
  CHECK(test::error_of([&] { TransferFunction(grey(0, 1), ramp, detail); }).find("second axis") != std::string::npos);
  CHECK(test::error_of([&] { TransferFunction(grey(0, 1), OpacityCurve{{}}, {}); }).find("no points") != std::string::npos);
}

TEST_CASE("derivatives: mean curvature of balls, tubes and planes, and the second derivative along the gradient") {
  Vec3f g;
  SecondDerivatives h;
  const auto ball = [](Vec3 p) { return 5 - length(p); };  // larger inside
  derivatives(ball, {1.2, -0.9, 2.0}, g, h);
  CHECK(mean_curvature(g, h) == doctest::Approx(1 / length(Vec3{1.2, -0.9, 2.0})).epsilon(1e-3));
  CHECK(second_derivative_along(g, h) == doctest::Approx(0).epsilon(1e-3));
  derivatives([&](Vec3 p) { return -ball(p); }, {1.2, -0.9, 2.0}, g, h);
  CHECK(mean_curvature(g, h) == doctest::Approx(-1 / length(Vec3{1.2, -0.9, 2.0})).epsilon(1e-3));
  derivatives([](Vec3 p) { return -std::hypot(p.x, p.y); }, {3, 4, 1}, g, h);
  CHECK(mean_curvature(g, h) == doctest::Approx(0.5 / 5).epsilon(1e-3));
  const auto plane = [](Vec3 p) { return std::erf(p.x + 0.4); };
  derivatives(plane, {0.1, 2, 3}, g, h);
  CHECK(mean_curvature(g, h) == doctest::Approx(0).epsilon(1e-3));
  CHECK(second_derivative_along(g, h) == doctest::Approx(-2 * 0.5 * 2 / std::sqrt(std::acos(-1.0)) * std::exp(-0.25)).epsilon(1e-3));
  // A rotation does not change it: h is a symmetric matrix, not three numbers.
  derivatives([&](Vec3 p) { return plane({0.6 * p.x + 0.8 * p.z, p.y, 0}); }, {0.1 * 0.6, 2, 0.1 * 0.8}, g, h);
  CHECK(second_derivative_along(g, h) == doctest::Approx(-2 / std::sqrt(std::acos(-1.0)) * std::exp(-0.25)).epsilon(1e-3));
  CHECK(mean_curvature({0, 0, 0}, h) == 0);
  CHECK(second_derivative_along({0, 0, 0}, h) == 0);
}
