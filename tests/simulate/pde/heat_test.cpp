// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/heat.h"

#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "simulate/pde/modes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::pde;
using sg::test::pi;

namespace {

constexpr HeatScheme schemes[] = {HeatScheme::explicit_euler, HeatScheme::crank_nicolson, HeatScheme::backward_euler};

HeatParams params(int size, int axes, HeatScheme scheme, const std::string& initial, const std::string& sides = "insulated") {
  HeatParams p;
  p.size = size, p.bounds = test::unit_box(axes), p.scheme = scheme, p.initial = initial, p.sides = sides;
  p.diffusivity = 1, p.tolerance = 1e-13, p.type = FieldType::f64;
  return p;
}

Heat after(HeatParams p, double step, int steps) {
  p.step = p.frame = step;
  const Context context;
  Heat h(p, context);
  for (int i = 0; i < steps; ++i) h.advance(context);
  return h;
}

double largest_of(const Values& u) { return fluid::largest(u, Context()); }
double mean_of(const Values& u) {
  double s = 0;
  for (const double v : u.values) s += v;
  return s / double(u.values.size());
}

}  // namespace

TEST_CASE("heat: a mode shrinks by its scheme's closed form of the discrete eigenvalue") {
  for (const HeatScheme scheme : schemes)
    for (const int axes : {1, 2, 3}) {
      const double dt = 5e-4 / axes, n = 15, l = axes * 4 * (n + 1) * (n + 1) * std::pow(std::sin(pi / (2 * (n + 1))), 2);
      const double factor = scheme == HeatScheme::explicit_euler   ? 1 - dt * l
                            : scheme == HeatScheme::backward_euler ? 1 / (1 + dt * l)
                                                                   : (1 - dt * l / 2) / (1 + dt * l / 2);
      const char* mode = axes == 1 ? "sin(pi*x)" : axes == 2 ? "sin(pi*x)*sin(pi*y)" : "sin(pi*x)*sin(pi*y)*sin(pi*z)";
      const Heat h = after(params(16, axes, scheme, mode, "0"), dt, 5);
      CHECK(test::largest_error(h.room(), h.values(), [&](Vec3 p) {
              return std::pow(factor, 5) * std::sin(pi * p.x) * (axes > 1 ? std::sin(pi * p.y) : 1) * (axes > 2 ? std::sin(pi * p.z) : 1);
            }) < 1e-10);
    }
}

TEST_CASE("heat: modes shrink by exp(-kappa k^2 t), with order 2 in space") {
  for (const HeatScheme scheme : schemes) {
    double h[4], error[4];
    for (int i = 0; i < 4; ++i) {
      const int size = 8 << i;
      h[i] = 1.0 / size;
      HeatParams p = params(size, 2, scheme, "cos(pi*x)*cos(2*pi*y)");
      p.frame = 0.02;
      if (scheme == HeatScheme::explicit_euler) p.step = h[i] * h[i] / 20;
      if (scheme == HeatScheme::crank_nicolson) p.step = 0.02 / (4 << i);
      if (scheme == HeatScheme::backward_euler) p.step = 0.02 / (16 << (2 * i));
      const Context context;
      Heat run(p, context);
      run.advance(context);
      error[i] = test::largest_error(run.room(), run.values(),
                                     [](Vec3 q) { return std::exp(-5 * pi * pi * 0.02) * std::cos(pi * q.x) * std::cos(2 * pi * q.y); });
    }
    CHECK(test::observed_order(h, error, 4) == doctest::Approx(2).epsilon(0.1));
  }
}

TEST_CASE("heat: the schemes have order 1, 2 and 1 in time, with sides and sources that change") {
  // u = exp(-t) x^2 + sin(t) x is exact in space: L u = 2 exp(-t).
  for (const HeatScheme scheme : schemes) {
    double dt[4], error[4];
    for (int i = 0; i < 4; ++i) {
      HeatParams p = params(6, 1, scheme, "x^2", "exp(-time)*x^2+sin(time)*x");
      p.diffusivity = 0.1, p.source = "-exp(-time)*x^2+cos(time)*x-0.2*exp(-time)";
      p.frame = 1, p.step = dt[i] = 0.1 / (1 << i);
      const Context context;
      Heat run(p, context);
      run.advance(context);
      error[i] = test::largest_error(run.room(), run.values(), [](Vec3 q) { return std::exp(-1) * q.x * q.x + std::sin(1) * q.x; });
    }
    CHECK(test::observed_order(dt, error, 4) == doctest::Approx(scheme == HeatScheme::crank_nicolson ? 2 : 1).epsilon(0.1));
  }
}

TEST_CASE("heat: explicit steps are stable up to h^2/2, h^2/4 and h^2/6 in 1, 2 and 3 dimensions, and no further") {
  for (const int axes : {1, 2, 3}) {
    const int size = 8;
    const double h = 1.0 / size, limit = h * h / (2 * axes);
    // A chessboard is the mode of the largest eigenvalue, 4 d / h^2.
    std::string board = "cos(8*pi*(x-1/16))";
    if (axes > 1) board += "*cos(8*pi*(y-1/16))";
    if (axes > 2) board += "*cos(8*pi*(z-1/16))";
    const HeatParams p = params(size, axes, HeatScheme::explicit_euler, board, "periodic");
    CHECK(Heat(p, Context()).limit() == doctest::Approx(limit));
    CHECK(largest_of(after(p, 0.99 * limit, 200).values()) == doctest::Approx(std::pow(0.98, 200)).epsilon(1e-6));
    CHECK(largest_of(after(p, 1.01 * limit, 200).values()) == doctest::Approx(std::pow(1.02, 200)).epsilon(1e-6));
    for (const HeatScheme scheme : {HeatScheme::crank_nicolson, HeatScheme::backward_euler})
      CHECK(largest_of(after(params(size, axes, scheme, board, "periodic"), 50 * limit, 20).values()) < 1);
  }
}

TEST_CASE("heat: steps beyond the limit warn, stay finite for a while, and end with an error that names the step") {
  Context context;
  std::string said;
  context.on_log = [&](LogLevel, std::string_view text) { said += text; };
  HeatParams p = params(32, 1, HeatScheme::explicit_euler, "abs(x-0.5)<0.2");
  p.step = p.frame = 1e-3, p.time = 0.01;
  const Array a = heat(p, context)->fields().require("temperature").array;
  CHECK(test::contains(said, "beyond the limit of 0.0004883"));
  for (size_t i = 0; i < a.count(); ++i) CHECK(std::isfinite(a.get(i)));
  p.time = 10;
  const std::string error = test::error_of([&] { heat(p, context); });
  CHECK(test::contains(error, "beyond all numbers in step "));
  CHECK(test::contains(error, "stable up to 0.0004883"));
}

TEST_CASE("heat: the mean is kept between insulated and between periodic sides") {
  for (const char* sides : {"insulated", "periodic"})
    for (const HeatScheme scheme : schemes) {
      const HeatParams p = params(20, 2, scheme, "exp(-20*(x-0.3)^2-9*y)", sides);
      const double mean = mean_of(Heat(p, Context()).values());
      CHECK(mean_of(after(p, scheme == HeatScheme::explicit_euler ? 5e-4 : 1e-2, 20).values()) == doctest::Approx(mean).epsilon(1e-11));
    }
}

TEST_CASE("heat: values stay between the least and the largest of the beginning and of the sides") {
  for (const HeatScheme scheme : {HeatScheme::explicit_euler, HeatScheme::backward_euler}) {
    const HeatParams p = params(24, 2, scheme, "hypot(x-0.5,y-0.5)<0.3", "0.25");
    const Heat h = after(p, scheme == HeatScheme::explicit_euler ? 0.999 / (4 * 576.0) : 0.05, 10);
    for (const double v : h.values().values) CHECK((v >= -1e-12 && v <= 1 + 1e-12));
  }
}

TEST_CASE("heat: the dataset is the same in any order of times and on any number of threads") {
  const auto bytes = [](double time, int threads) {
    set_thread_count(threads);
    Context context;
    HeatParams p;
    p.bounds = {0, 1, 0, 0.7, 0, 0.4}, p.size = 40, p.time = time, p.frame = 0.01, p.scheme = HeatScheme::crank_nicolson,
    p.x0 = "sin(5*time)";
    const DatasetPtr d = heat(p, context);
    set_thread_count(0);
    std::vector<double> v(d->point_count());
    for (size_t i = 0; i < v.size(); ++i) v[i] = d->fields().require("temperature").array.get(i);
    return v;
  };
  const auto late = bytes(0.05, 1), early = bytes(0.02, 4);
  CHECK(bytes(0.05, 3) == late);
  CHECK(bytes(0.02, 1) == early);
  CHECK(early != late);
}

TEST_CASE("heat: bad input is told, and one cell, no diffusion and no time are right") {
  Context context;
  const HeatParams good = params(8, 2, HeatScheme::explicit_euler, "x");
  const auto error = [&](auto change) {
    HeatParams p = good;
    change(p);
    return test::error_of([&] { heat(p, context); });
  };
  CHECK(test::contains(error([](HeatParams& p) { p.initial = "sqrt(x-0.5)"; }), "heat initial"));
  CHECK(test::contains(error([](HeatParams& p) { p.initial = "x+"; }), "heat initial"));
  CHECK(test::contains(error([](HeatParams& p) { p.initial = "temprature"; }), "heat initial"));
  CHECK(test::contains(error([](HeatParams& p) { p.source = "1/(time*0)"; }), "heat source"));
  CHECK(test::contains(error([](HeatParams& p) { p.x0 = "insulate"; }), "heat x0: 'insulate' is not a field"));
  CHECK(test::contains(error([](HeatParams& p) { p.x0 = "insulate"; }), "a side is insulated, periodic"));
  CHECK(test::contains(error([](HeatParams& p) { p.step = 0; }), "heat step"));
  CHECK(test::contains(error([](HeatParams& p) { p.step = -1; }), "heat step"));
  CHECK(test::contains(error([](HeatParams& p) { p.step = HUGE_VAL; }), "heat step"));
  CHECK(test::contains(error([](HeatParams& p) { p.step = NAN; }), "heat step"));
  CHECK(test::contains(error([](HeatParams& p) { p.step = 1e-12; }), "steps"));
  CHECK(test::contains(error([](HeatParams& p) { p.frame = HUGE_VAL, p.time = 1; }), "heat frame"));
  CHECK(test::contains(error([](HeatParams& p) { p.diffusivity = -1; }), "heat diffusivity"));
  CHECK(test::contains(error([](HeatParams& p) { p.diffusivity = NAN; }), "heat diffusivity"));
  HeatParams one = params(1, 3, HeatScheme::backward_euler, "3");
  one.time = 1;
  CHECK(heat(one, context)->fields().require("temperature").array.get(0) == doctest::Approx(3));
  HeatParams still = good;
  still.diffusivity = 0, still.time = 1;
  CHECK(heat(still, context)->fields().require("temperature").array.get(3) == doctest::Approx(3.5 / 8));
}
