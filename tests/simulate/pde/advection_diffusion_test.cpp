// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/advection_diffusion.h"

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

AdvectionDiffusionParams ad_params(int size, int axes, FluxScheme scheme, const std::string& initial, const std::string& velocity) {
  AdvectionDiffusionParams p;
  p.size = size, p.bounds = test::unit_box(axes), p.scheme = scheme, p.initial = initial, p.velocity = velocity, p.sides = "periodic";
  p.type = FieldType::f64;
  return p;
}

AdvectionDiffusion ad_after(const AdvectionDiffusionParams& p, int frames) {
  const Context context;
  AdvectionDiffusion r(p, context);
  for (int i = 0; i < frames; ++i) r.advance(context);
  return r;
}

double sum_of(const Values& u) {
  double s = 0;
  for (const double v : u.values) s += v;
  return s;
}

}  // namespace

TEST_CASE("advection_diffusion: a wave moves and shrinks as exp(-kappa k^2 t) cos k(x - u t), with each scheme's order") {
  for (const FluxScheme scheme : {FluxScheme::upwind, FluxScheme::central, FluxScheme::limited}) {
    const bool plane = scheme == FluxScheme::central;
    double h[4], error[4];
    for (int i = 0; i < 4; ++i) {
      const int size = (plane ? 16 : 64) << i;
      AdvectionDiffusionParams p = ad_params(size, plane ? 2 : 1, scheme, plane ? "cos(2*pi*(x+y))" : "cos(2*pi*x)", "vec(1,0.5,0)");
      p.diffusivity = 0.002, p.frame = 0.2;
      const AdvectionDiffusion r = ad_after(p, 1);
      const UniformGrid g = r.room().grid();
      // Limited slopes flatten extremes: their order is that of the mean error.
      double sum = 0, worst = 0;
      for (size_t k = 0; k < r.values().values.size(); ++k) {
        const double x = g.origin.x + g.spacing.x * double(k % g.dims[0]), y = g.origin.y + g.spacing.y * double(k / g.dims[0]);
        const double exact = plane ? std::exp(-0.002 * 8 * pi * pi * 0.2) * std::cos(2 * pi * (x + y - 0.3))
                                   : std::exp(-0.002 * 4 * pi * pi * 0.2) * std::cos(2 * pi * (x - 0.2));
        const double e = std::abs(r.values().values[k] - exact);
        sum += e, worst = std::max(worst, e);
      }
      h[i] = 1.0 / size, error[i] = scheme == FluxScheme::limited ? sum / double(r.values().values.size()) : worst;
    }
    const double order = test::observed_order(h, error, 4);
    CAPTURE(order);
    CHECK(order > (scheme == FluxScheme::upwind ? 0.9 : 1.9));
    CHECK(order < (scheme == FluxScheme::upwind ? 1.1 : scheme == FluxScheme::limited ? 2.4 : 2.1));
  }
}

TEST_CASE("advection_diffusion: the error of upwind is the diffusivity |u| h / 2") {
  AdvectionDiffusionParams p = ad_params(128, 1, FluxScheme::upwind, "cos(2*pi*x)", "vec(1,0,0)");
  p.diffusivity = 0, p.frame = 1, p.step = 1e-4;
  double amplitude = 0;
  const AdvectionDiffusion r = ad_after(p, 1);
  for (const double v : r.values().values) amplitude = std::max(amplitude, v);
  // Exactly exp(-2 sin^2(pi h) u t / h): what kappa = u h / 2 gives the second difference.
  CHECK(amplitude == doctest::Approx(std::exp(-2 * 128 * std::pow(std::sin(pi / 128), 2))).epsilon(1e-3));
}

TEST_CASE("advection_diffusion: upwind and limited make no new extremes, central does; all keep the sum") {
  for (const FluxScheme scheme : {FluxScheme::upwind, FluxScheme::central, FluxScheme::limited}) {
    AdvectionDiffusionParams p = ad_params(64, 1, scheme, "abs(x-0.5)<0.2", "vec(1,0,0)");
    p.diffusivity = 0, p.frame = 0.1;
    const double before = sum_of(ad_after(p, 0).values());
    const AdvectionDiffusion r = ad_after(p, 10);
    double lo = 1, hi = 0;
    for (const double v : r.values().values) lo = std::min(lo, v), hi = std::max(hi, v);
    CHECK(sum_of(r.values()) == doctest::Approx(before).epsilon(1e-12));
    CHECK((lo < -1e-3) == (scheme == FluxScheme::central));
    CHECK((hi > 1 + 1e-3) == (scheme == FluxScheme::central));
    if (scheme == FluxScheme::limited) CHECK(hi > 0.99);
    if (scheme == FluxScheme::upwind) CHECK(hi < 0.95);
  }
}

TEST_CASE("advection_diffusion: a steady boundary layer between held sides, (exp(u x / kappa) - 1) / (exp(u / kappa) - 1)") {
  double h[4], error[4];
  for (int i = 0; i < 4; ++i) {
    AdvectionDiffusionParams p = ad_params(16 << i, 1, FluxScheme::central, "x", "vec(1,0,0)");
    p.sides = "0", p.x1 = "1", p.diffusivity = 0.2, p.frame = 2;
    const AdvectionDiffusion r = ad_after(p, 2);
    h[i] = 1.0 / (16 << i);
    error[i] = test::largest_error(r.room(), r.values(), [](Vec3 q) { return std::expm1(5 * q.x) / std::expm1(5); });
  }
  CHECK(test::observed_order(h, error, 4) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("advection_diffusion: a flow along insulated sides keeps the sum; one through them carries out what is there") {
  AdvectionDiffusionParams p =
      ad_params(40, 2, FluxScheme::limited, "exp(-40*((x-0.4)^2+(y-0.6)^2))", "vec(sin(pi*x)*cos(pi*y),-cos(pi*x)*sin(pi*y),0)");
  p.sides = "insulated", p.diffusivity = 1e-3;
  CHECK(sum_of(ad_after(p, 30).values()) == doctest::Approx(sum_of(ad_after(p, 0).values())).epsilon(1e-12));
  AdvectionDiffusionParams out = ad_params(40, 1, FluxScheme::limited, "exp(-200*(x-0.4)^2)", "vec(1,0,0)");
  out.sides = "insulated", out.frame = 2, out.diffusivity = 0;
  CHECK(sum_of(ad_after(out, 1).values()) < 1e-9);
}

TEST_CASE("advection_diffusion: a swinging flow brings everything back; the same bytes on any number of threads") {
  AdvectionDiffusionParams p = ad_params(128, 1, FluxScheme::central, "exp(-100*(x-0.5)^2)", "vec(0.5*cos(2*pi*time),0,0)");
  p.diffusivity = 0, p.frame = 0.05;
  const AdvectionDiffusion r = ad_after(p, 20);
  CHECK(test::largest_error(r.room(), r.values(), [](Vec3 q) { return std::exp(-100 * (q.x - 0.5) * (q.x - 0.5)); }) < 0.01);
  const auto values = [](int threads) {
    set_thread_count(threads);
    AdvectionDiffusionParams q;
    q.bounds = {0, 1, 0, 1, 0, 0.5}, q.size = 30, q.x0 = "sin(time)";
    const auto v = ad_after(q, 5).values().values;
    set_thread_count(0);
    return v;
  };
  CHECK(values(1) == values(4));
}

TEST_CASE("advection_diffusion: bad input is told") {
  Context context;
  const auto error = [&](auto change) {
    AdvectionDiffusionParams p;
    p.size = 16;
    change(p);
    return test::error_of([&] { advection_diffusion(p, context); });
  };
  CHECK(test::contains(error([](AdvectionDiffusionParams& p) { p.velocity = "x"; }), "vec(u,v,w)"));
  CHECK(test::contains(error([](AdvectionDiffusionParams& p) { p.velocity = "vec(1/(x-x),0,0)"; }), "velocity"));
  CHECK(test::contains(error([](AdvectionDiffusionParams& p) { p.initial = "sqrt(-1-x)"; }), "initial"));
  CHECK(test::contains(error([](AdvectionDiffusionParams& p) { p.diffusivity = -1; }), "diffusivity"));
  CHECK(test::contains(error([](AdvectionDiffusionParams& p) { p.step = 0; }), "step"));
  CHECK(test::contains(error([](AdvectionDiffusionParams& p) { p.step = HUGE_VAL; }), "step"));
  CHECK(test::contains(error([](AdvectionDiffusionParams& p) { p.step = p.frame = 1, p.time = 2000; }), "beyond all numbers in step"));
  AdvectionDiffusionParams one;
  one.size = 1, one.initial = "2", one.velocity = "vec(0,0,0)", one.time = 1;
  CHECK(advection_diffusion(one, context)->fields().require("concentration").array.get(0) == doctest::Approx(2));
}
