// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/poisson.h"

#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "simulate/pde/modes.h"
#include "support/test.h"

using namespace sg;
using sg::test::pi;

namespace {

PoissonParams problem(int size, int axes, const std::string& source, const std::string& sides = "0") {
  PoissonParams p;
  p.size = size, p.bounds = test::unit_box(axes), p.source = source, p.sides = sides;
  p.type = FieldType::f64, p.tolerance = 1e-12;
  return p;
}

template <class F>
double error_to(const DatasetPtr& d, F&& f) {
  const auto& g = *d->as<UniformGrid>();
  const Array& a = d->fields().require("potential").array;
  double worst = 0;
  for (size_t i = 0; i < a.count(); ++i) {
    const Vec3 at =
        g.origin + g.spacing * Vec3(double(i % g.dims[0]), double(i / g.dims[0] % g.dims[1]), double(i / (g.dims[0] * g.dims[1])));
    worst = std::max(worst, std::abs(a.get(i) - f(at)));
  }
  return worst;
}

}  // namespace

TEST_CASE("poisson: a made-up solution is met with order 2 between held, mixed and insulated sides") {
  Context context;
  struct Case {
    int axes;
    const char *source, *sides, *x1;
    double (*u)(Vec3);
  };
  const Case cases[] = {
      {2, "2*pi^2*sin(pi*x)*sin(pi*y)", "0", "", [](Vec3 p) { return std::sin(pi * p.x) * std::sin(pi * p.y); }},
      {2, "-2*exp(x-y)", "exp(x-y)", "", [](Vec3 p) { return std::exp(p.x - p.y); }},
      {3, "3*pi^2*cos(pi*x)*cos(pi*y)*cos(pi*z)", "insulated", "",
       [](Vec3 p) { return std::cos(pi * p.x) * std::cos(pi * p.y) * std::cos(pi * p.z); }},
      {1, "(pi/2)^2*sin(pi*x/2)", "0", "insulated", [](Vec3 p) { return std::sin(pi * p.x / 2); }},
      {2, "8*pi^2*sin(2*pi*x)*cos(2*pi*y)", "periodic", "", [](Vec3 p) { return std::sin(2 * pi * p.x) * std::cos(2 * pi * p.y); }},
  };
  for (const Case& c : cases) {
    double h[4], error[4];
    for (int i = 0; i < 4; ++i) {
      PoissonParams p = problem(8 << i, c.axes, c.source, c.sides);
      p.x1 = c.x1;
      h[i] = 1.0 / (8 << i), error[i] = error_to(poisson(p, context), c.u);
    }
    CAPTURE(c.source);
    CHECK(test::observed_order(h, error, 4) == doctest::Approx(2).epsilon(0.05));
  }
}

TEST_CASE("poisson: linear solutions of Laplace's equation are exact, and the walls are shown") {
  Context context;
  const auto u = [](Vec3 p) { return 2 * p.x - 3 * p.y + 0.5 * p.z + 1; };
  PoissonParams p = problem(12, 3, "0", "2*x-3*y+0.5*z+1");
  p.bounds = {-1, 1, 0, 1, 2, 3};
  const DatasetPtr d = poisson(p, context);
  CHECK(error_to(d, u) < 1e-9);
  CHECK(d->bounds().lo == Vec3(-1, 0, 2));
  CHECK(d->bounds().hi.x == doctest::Approx(1));
  // Insulated across, it is a slope along x alone.
  PoissonParams slope = problem(10, 2, "0", "insulated");
  slope.x0 = "1", slope.x1 = "3";
  CHECK(error_to(poisson(slope, context), [](Vec3 q) { return 1 + 2 * q.x; }) < 1e-9);
}

TEST_CASE("poisson: the largest value is on the border where there is no source (maximum principle)") {
  Context context;
  const DatasetPtr d = poisson(problem(33, 2, "0", "sin(7*x)*cos(5*y)+x"), context);
  const auto& g = *d->as<UniformGrid>();
  const Array& a = d->fields().require("potential").array;
  double inside_lo = 1e9, inside_hi = -1e9, lo = 1e9, hi = -1e9;
  for (size_t i = 0; i < a.count(); ++i) {
    const size_t x = i % g.dims[0], y = i / g.dims[0];
    const bool border = x == 0 || y == 0 || x + 1 == g.dims[0] || y + 1 == g.dims[1];
    (border ? lo : inside_lo) = std::min(border ? lo : inside_lo, a.get(i)),
                   (border ? hi : inside_hi) = std::max(border ? hi : inside_hi, a.get(i));
  }
  CHECK(inside_lo >= lo);
  CHECK(inside_hi <= hi);
}

TEST_CASE("poisson: the history of residuals ends at the tolerance; the table has a column a solver") {
  Context context;
  PoissonParams p = problem(32, 2, "1");
  p.tolerance = 1e-6;
  const Array r = poisson(p, context)->fields().require("residual", Association::whole).array;
  CHECK(r.get(0) == doctest::Approx(1));
  CHECK(r.get(r.count() - 1) <= 1e-6);
  CHECK(r.get(r.count() - 2) > 1e-6);
  PoissonConvergenceParams q;
  q.size = 16;
  const TablePtr t = poisson_convergence(q, context);
  CHECK(t->columns.size() == 6);
  CHECK(t->columns[0].name == "iteration");
  CHECK(t->columns[0].array.count() == 201);
  CHECK(std::isfinite(t->columns[1].array.get(200)));  // jacobi is far from done
  CHECK(std::isnan(t->columns[5].array.get(200)));     // multigrid is
  q.log = true;
  CHECK(poisson_convergence(q, context)->columns[1].array.get(200) == doctest::Approx(std::log10(t->columns[1].array.get(200))));
}

TEST_CASE("poisson: nothing to hold the value, no source, one cell, and what is not a number") {
  Context context;
  CHECK(test::contains(test::error_of([&] { poisson(problem(8, 2, "1", "insulated"), context); }), "hold the value at a side"));
  CHECK(error_to(poisson(problem(8, 2, "0", "insulated"), context), [](Vec3) { return 0.0; }) == 0);
  CHECK(error_to(poisson(problem(1, 1, "8", "0"), context), [](Vec3 p) { return p.x == 0.5 ? 1.0 : 0.0; }) <
        1e-12);  // (2/h^2) u = 8, h = 1/2
  CHECK(poisson(problem(1, 3, "0", "insulated"), context)->point_count() == 1);
  CHECK(test::contains(test::error_of([&] { poisson(problem(9, 2, "1/(x-0.5)", "insulated"), context); }), "poisson source"));
  CHECK(test::contains(test::error_of([&] { poisson(problem(8, 2, "1", "sqrt(-1-x)"), context); }), "not a number"));
  CHECK(test::contains(test::error_of([&] { poisson(problem(8, 2, "1", "absorbing"), context); }), "waves"));
  PoissonParams p = problem(8, 2, "1");
  p.x0 = "periodic";
  CHECK(test::contains(test::error_of([&] { poisson(p, context); }), "make both periodic"));
  p.x0 = "", p.bounds = {0, 0, 1, 1, 2, 2};
  CHECK(test::contains(test::error_of([&] { poisson(p, context); }), "no extent"));
  p.bounds = {0, 1, 0, NAN, 0, 0};
  CHECK(test::contains(test::error_of([&] { poisson(p, context); }), "finite"));
}
