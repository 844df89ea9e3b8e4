// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/wave.h"

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

WaveParams wave_params(int size, int axes, const std::string& initial, const std::string& sides = "0") {
  WaveParams p;
  p.size = size, p.bounds = test::unit_box(axes), p.initial = initial, p.sides = sides, p.type = FieldType::f64;
  return p;
}

Wave wave_after(WaveParams p, double step, int steps) {
  p.step = p.frame = step;
  const Context context;
  Wave w(p, context);
  for (int i = 0; i < steps; ++i) w.advance(context);
  return w;
}

double highest(const Wave& w) { return fluid::largest(w.values(), Context()); }

}  // namespace

TEST_CASE("wave: in one dimension, steps of a cell move both halves of a bump by whole cells, without error") {
  const WaveParams p = wave_params(128, 1, "exp(-500*(x-0.5)^2)", "periodic");
  for (const int steps : {1, 20, 128, 1000}) {
    const Wave w = wave_after(p, 1.0 / 128, steps);
    const auto bump = [](double x) { return std::exp(-500 * std::pow(x - std::floor(x) - 0.5, 2)); };
    CHECK(test::largest_error(w.room(), w.values(), [&](Vec3 q) { return (bump(q.x - steps / 128.0) + bump(q.x + steps / 128.0)) / 2; }) <
          1e-11);
  }
}

TEST_CASE("wave: a moving wave is turned over at a fixed side, thrown back at a reflecting one, and leaves through an absorbing one") {
  const auto pulse = [](double x) { return std::exp(-500 * (x - 0.5) * (x - 0.5)); };
  struct Case {
    const char* side;
    double sign;
  };
  for (const Case c : {Case{"0", -1}, Case{"reflecting", 1}, Case{"absorbing", 0}}) {
    WaveParams p = wave_params(128, 1, "exp(-500*(x-0.5)^2)", c.side);
    p.velocity = "1000*(x-0.5)*exp(-500*(x-0.5)^2)";  // to the right: -u'
    const double h = make_room(p, "t", 1, true, Context()).axes[0].h();
    const int steps = int(std::lround(1 / h));  // back in the middle
    const Wave w = wave_after(p, h, steps);
    const double error = test::largest_error(w.room(), w.values(), [&](Vec3 q) { return c.sign * pulse(q.x); });
    CAPTURE(c.side);
    CHECK(error < 0.012);  // the second-order beginning
  }
}

TEST_CASE("wave: modes turn at the frequency of the discrete dispersion relation, in 1, 2 and 3 dimensions") {
  for (const int axes : {1, 2, 3}) {
    std::string mode = "sin(pi*x)";
    if (axes > 1) mode += "*sin(pi*y)";
    if (axes > 2) mode += "*sin(pi*z)";
    const double n = 15, lambda = axes * 4 * (n + 1) * (n + 1) * std::pow(std::sin(pi / (2 * (n + 1))), 2);
    const double dt = 0.9 / 16 / std::sqrt(double(axes)), w = 2 / dt * std::asin(dt * std::sqrt(lambda) / 2);
    const Wave run = wave_after(wave_params(16, axes, mode), dt, 40);
    CHECK(test::largest_error(run.room(), run.values(), [&](Vec3 p) {
            return std::cos(w * 40 * dt) * std::sin(pi * p.x) * (axes > 1 ? std::sin(pi * p.y) : 1) * (axes > 2 ? std::sin(pi * p.z) : 1);
          }) < 1e-10);
  }
}

TEST_CASE("wave: a drum's mode with a velocity and a source, with order 2") {
  double h[4], error[4];
  for (int i = 0; i < 4; ++i) {
    WaveParams p = wave_params(8 << i, 2, "0");
    p.velocity = "2*sin(pi*x)*sin(pi*y)", p.source = "(2*pi^2-4)*sin(2*time)*sin(pi*x)*sin(pi*y)";
    p.frame = 0.5;
    const Context context;
    Wave w(p, context);
    w.advance(context);
    h[i] = 1.0 / (8 << i);
    error[i] = test::largest_error(w.room(), w.values(), [](Vec3 q) { return std::sin(1.0) * std::sin(pi * q.x) * std::sin(pi * q.y); });
  }
  CHECK(test::observed_order(h, error, 4) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("wave: steps are stable up to h / (c sqrt(d)), and no further") {
  for (const int axes : {1, 2, 3}) {
    std::string board = "cos(8*pi*(x-1/16))";
    if (axes > 1) board += "*cos(8*pi*(y-1/16))";
    if (axes > 2) board += "*cos(8*pi*(z-1/16))";
    WaveParams p = wave_params(8, axes, board, "periodic");
    p.speed = 3;
    const double limit = 1.0 / 8 / 3 / std::sqrt(double(axes));
    CHECK(Wave(p, Context()).limit() == doctest::Approx(limit));
    CHECK(highest(wave_after(p, 0.99 * limit, 300)) <= 1 + 1e-9);
    // 1.01 of it: q + 1/q = 2 - 4 * 1.01^2 has |q| = 1.327.
    const double b = 1 - 2 * 1.01 * 1.01, q = std::abs(b) + std::sqrt(b * b - 1);
    CHECK(highest(wave_after(p, 1.01 * limit, 50)) == doctest::Approx((std::pow(q, 50) + std::pow(q, -50)) / 2).epsilon(1e-6));
  }
  Context context;
  std::string said;
  context.on_log = [&](LogLevel, std::string_view text) { said += text; };
  WaveParams p = wave_params(16, 2, "exp(-50*((x-0.5)^2+(y-0.5)^2))");
  p.step = p.frame = 0.1, p.time = 200;
  CHECK(test::contains(test::error_of([&] { wave(p, context); }), "beyond all numbers in step"));
  CHECK(test::contains(said, "beyond the limit"));
}

TEST_CASE("wave: most of a round wave leaves a square of absorbing sides") {
  const WaveParams p = wave_params(64, 2, "exp(-200*((x-0.5)^2+(y-0.5)^2))", "absorbing");
  CHECK(highest(wave_after(p, 0.01, 200)) < 0.02);
  CHECK(highest(wave_after(wave_params(64, 2, p.initial, "reflecting"), 0.01, 200)) > 0.1);
}

TEST_CASE("wave: the same bytes on any number of threads; bad input is told") {
  const auto values = [](int threads) {
    set_thread_count(threads);
    WaveParams p;
    p.size = 100, p.x1 = "absorbing", p.y0 = "0.1*sin(9*time)";
    const Wave w = wave_after(p, 0.005, 30);
    set_thread_count(0);
    return w.values().values;
  };
  CHECK(values(1) == values(4));
  Context context;
  WaveParams p;
  p.velocity = "1/(x-x)";
  CHECK(test::contains(test::error_of([&] { wave(p, context); }), "wave velocity"));
  p = {};
  p.speed = -1;
  CHECK(test::contains(test::error_of([&] { wave(p, context); }), "wave speed"));
  p = {};
  p.step = 0;
  CHECK(test::contains(test::error_of([&] { wave(p, context); }), "wave step"));
  WaveParams one;
  one.size = 1, one.sides = "reflecting", one.initial = "2", one.time = 1;
  CHECK(wave(one, context)->fields().require("height").array.get(0) == doctest::Approx(2));
}
