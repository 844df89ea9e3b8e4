// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/reaction_diffusion.h"

#include <algorithm>
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

ReactionDiffusion rd_after(const ReactionDiffusionParams& p, int frames) {
  const Context context;
  ReactionDiffusion r(p, context);
  for (int i = 0; i < frames; ++i) r.advance(context);
  return r;
}

}  // namespace

TEST_CASE("reaction_diffusion: states of rest stay at rest") {
  ReactionDiffusionParams p;
  p.size = 16, p.initial_u = "1", p.initial_v = "0";
  const ReactionDiffusion gray = rd_after(p, 5);
  CHECK(test::largest_error(gray.room(), gray.u(), [](Vec3) { return 1.0; }) < 1e-14);
  CHECK(test::largest_error(gray.room(), gray.v(), [](Vec3) { return 0.0; }) == 0);
  // The other one of Gray and Scott: v = (1 - u) feed / (feed + kill), u v = feed + kill.
  p.feed = 0.04, p.kill = 0.05;
  const double g = p.feed / (p.feed + p.kill), root = std::sqrt(1 - 4 * (p.feed + p.kill) / g), u = (1 - root) / 2, v = g * (1 + root) / 2;
  CHECK(u * v == doctest::Approx(p.feed + p.kill));
  p.initial_u = std::to_string(u), p.initial_v = std::to_string(v);
  const ReactionDiffusion other = rd_after(p, 1);
  CHECK(test::largest_error(other.room(), other.u(), [&](Vec3) { return u; }) < 1e-4);
  // FitzHugh and Nagumo: u - u^3/3 = v = (u + threshold) / damping.
  double w = -1.2;
  for (int i = 0; i < 50; ++i) w -= (w - w * w * w / 3 - (w + 0.7) / 0.8) / (1 - w * w - 1 / 0.8);
  ReactionDiffusionParams f;
  f.model = Reaction::fitzhugh_nagumo, f.size = 8;
  f.initial_u = "-1.2", f.initial_v = "-0.6";
  const ReactionDiffusion calm = rd_after(f, 30);
  CHECK(test::largest_error(calm.room(), calm.u(), [&](Vec3) { return w; }) < 1e-9);
}

TEST_CASE("reaction_diffusion: without feed and kill, what is lost of u is found in v; their sum spreads as heat") {
  ReactionDiffusionParams p;
  p.size = 32, p.feed = p.kill = 0, p.diffusivity_u = p.diffusivity_v = 1e-4, p.frame = 1;
  p.bounds = {0, 1, 0, 0, 0, 0};
  p.initial_u = "1+0.5*cos(2*pi*x)", p.initial_v = "0.5*(x<0.5)+0.25*cos(2*pi*x)+0.25-0.5*(x<0.5)";
  const ReactionDiffusion r = rd_after(p, 20);
  const double lambda = 4.0 * 32 * 32 * std::pow(std::sin(pi / 32), 2), t = 20;
  Values sum = r.u();
  for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += r.v().values[i];
  CHECK(test::largest_error(r.room(), sum, [&](Vec3 q) { return 1.25 + 0.75 * std::exp(-1e-4 * lambda * t) * std::cos(2 * pi * q.x); }) <
        1e-6);
  CHECK(test::largest_error(r.room(), r.v(), [](Vec3) { return 0.25; }) > 0.1);
}

TEST_CASE("reaction_diffusion: steps are of third order") {
  double dt[4], error[4];
  const auto run = [](double step) {
    ReactionDiffusionParams p;
    p.size = 2, p.initial_u = "0.6", p.initial_v = "0.4", p.frame = 8, p.step = step, p.type = FieldType::f64;
    return rd_after(p, 1).v().values[0];
  };
  const double exact = run(8.0 / 4096);
  for (int i = 0; i < 4; ++i) dt[i] = 2.0 / (1 << i), error[i] = std::abs(run(dt[i]) - exact);
  CHECK(test::observed_order(dt, error, 4) == doctest::Approx(3).epsilon(0.1));
}

TEST_CASE("reaction_diffusion: spots grow, the same on any number of threads; too long steps end with an error") {
  const auto values = [](int threads) {
    set_thread_count(threads);
    ReactionDiffusionParams p;
    p.size = 80;
    const ReactionDiffusion r = rd_after(p, 20);
    set_thread_count(0);
    return r.v().values;
  };
  const auto one = values(1);
  CHECK(one == values(4));
  // A spiral has no chessboard on it: neighbours differ less than what lies two apart.
  ReactionDiffusionParams f;
  f.model = Reaction::fitzhugh_nagumo, f.size = 160, f.sides = "insulated";
  const ReactionDiffusion wave = rd_after(f, 5);
  double uneven = 0;
  const auto& u = wave.u();
  for (size_t j = 0; j < u.n[1]; ++j)
    for (size_t i = 1; i + 2 < u.n[0]; ++i) {
      const double a = u(i, j, 0) - u(i - 1, j, 0), b = u(i + 1, j, 0) - u(i, j, 0), c = u(i + 2, j, 0) - u(i + 1, j, 0);
      if (a * b < 0 && b * c < 0) uneven = std::max(uneven, std::min({std::abs(a), std::abs(b), std::abs(c)}));
    }
  CHECK(uneven < 0.02);
  size_t high = 0;
  for (const double v : one) high += v > 0.2;
  CHECK(high > one.size() / 20);
  Context context;
  ReactionDiffusionParams p;
  p.step = 20, p.diffusivity_u = 1e-3, p.time = 2000;
  CHECK(test::contains(test::error_of([&] { reaction_diffusion(p, context); }), "beyond all numbers in step"));
  p = {};
  p.diffusivity_v = -1;
  CHECK(test::contains(test::error_of([&] { reaction_diffusion(p, context); }), "diffusivity"));
  p = {};
  p.initial_u = "log(x-x)";
  CHECK(test::contains(test::error_of([&] { reaction_diffusion(p, context); }), "initial_u"));
  p = {};
  p.step = HUGE_VAL;
  CHECK(test::contains(test::error_of([&] { reaction_diffusion(p, context); }), "step"));
}
