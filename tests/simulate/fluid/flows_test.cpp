// SPDX-License-Identifier: Apache-2.0
// Flows whose figures are known: the lid-driven cavity, the hydrostatic column, the vortex street.
#include <cmath>
#include <vector>

#include "simulate/fluid/smoke.h"
#include "support/test.h"

using namespace sg;
using namespace sg::fluid;

namespace {

SmokeParams plain_air(int size, std::vector<double> bounds) {
  SmokeParams p;
  p.size = size, p.bounds = std::move(bounds), p.density = p.temperature = 0, p.open = BoxSide::none, p.limit = false;
  return p;
}

// The velocity along x on the vertical line through the middle of a cavity whose lid slides at 1, once it is steady.
struct Cavity {
  std::vector<double> u;
  double at(double y) const {  // linear between the middles of cells
    const double place = y * double(u.size()) - 0.5;
    const size_t j = std::min(size_t(std::max(place, 0.0)), u.size() - 2);
    return u[j] + (place - double(j)) * (u[j + 1] - u[j]);
  }
};

Cavity cavity(int n, double reynolds) {
  Context context;
  SmokeParams p = plain_air(n, {0, 1, 0, 1, 0, 0});
  p.sides = "x0 held; x1 held; y0 held; y1 held 1,0,0", p.viscosity = 1 / reynolds, p.cfl = 1, p.frame = 0.5;
  Smoke<float> run(p, {}, context);
  Cavity now;
  for (int f = 0; f < 200; ++f) {
    run.advance(context);
    std::vector<double> u;
    for (int j = 0; j < n; ++j) u.push_back(run.velocity()[0](size_t(n / 2), size_t(j), 0));
    double change = 0;
    for (size_t j = 0; j < now.u.size(); ++j) change = std::max(change, std::abs(u[j] - now.u[j]));
    const bool steady = !now.u.empty() && change < 1e-4;
    now.u = u;
    if (steady) break;
  }
  return now;
}

}  // namespace

TEST_CASE("lid-driven cavity: the velocity on the middle line is that of Ghia, Ghia and Shin (1982), table I") {
  const double y[] = {0.9531, 0.8516, 0.7344, 0.6172, 0.5, 0.4531, 0.2813, 0.1719, 0.1016, 0.0547};
  struct Row {
    double reynolds;
    int n;
    double u[10];
  };
  const auto worst = [&](const Row& row, const Cavity& c) {
    double miss = 0;
    for (size_t i = 0; i < 10; ++i) miss = std::max(miss, std::abs(c.at(y[i]) - row.u[i]));
    return miss;
  };
  for (const Row& row : {Row{100, 48, {0.68717, 0.23151, 0.00332, -0.13641, -0.20581, -0.21090, -0.15662, -0.10150, -0.06434, -0.03717}},
                         Row{400, 64, {0.55892, 0.29093, 0.16256, 0.02135, -0.11477, -0.17119, -0.32726, -0.24299, -0.14612, -0.08186}},
                         Row{1000, 96, {0.46604, 0.33304, 0.18719, 0.05702, -0.06080, -0.10648, -0.27805, -0.38289, -0.29730, -0.18109}}}) {
    const double miss = worst(row, cavity(row.n, row.reynolds));
    MESSAGE("Re " << row.reynolds << ", " << row.n << "^2 cells: at most " << miss << " of the lid's speed away");
    CHECK(miss < 0.035);
    if (row.reynolds == 400) CHECK(worst(row, cavity(row.n / 2, row.reynolds)) > 1.8 * miss);
  }
}

TEST_CASE("hydrostatic column: the pressure of air that is evenly heavy grows downwards by weight times density") {
  Context context;
  SmokeParams p;
  p.type = FieldType::f64, p.size = 16, p.bounds = {0, 1, 0, 1, 0, 0}, p.box = {0, 1, 0, 1, 0, 0}, p.density = 2, p.temperature = 0,
  p.weight = 0.7;
  p.frame = 0.1;
  Smoke<double> run(p, {}, context);
  run.advance(context);
  const DatasetPtr d = run.dataset(context);
  const Array& pressure = d->fields().require("pressure").array;
  // p (length * velocity) of a step dt is dt times the pressure per density; the last step is the whole frame or a part of it.
  const double dt = 0.1 / double(run.steps()), h = 1.0 / 16;
  for (size_t j = 0; j < 16; ++j) {
    const double depth = 1 - (double(j) + 0.5) * h;
    CHECK(pressure.view<double>()[j * 16 + 5] * h / dt == doctest::Approx(0.7 * 2 * depth).epsilon(1e-4));
  }
  for (const Lattice<double>& l : run.velocity())
    for (const double v : l.values) CHECK(std::abs(v) < 1e-5);
}

TEST_CASE("vortex street: a cylinder at Re 100 sheds at a Strouhal number of 0.16 to 0.17") {
  Context context;
  // Diameter 1, stream 1 in a box of 24 x 16 diameters, a little below its middle: a symmetric flow would take long to begin.
  constexpr int cells = 12;  // a diameter
  SmokeParams p = plain_air(24 * cells, {-6, 18, -8.2, 7.8, 0, 0});
  p.sides = "x0 inflow 1,0,0; x1 open", p.obstacle = {0, 0, 0, 0.5}, p.viscosity = 0.01, p.cfl = 1.5, p.frame = 0.25;
  Smoke<float> run(p, {}, context);
  std::vector<double> times;  // at which the cross flow behind the cylinder turns upwards
  double before = 0;
  for (int f = 1; f <= 320; ++f) {
    run.advance(context);
    const double v = run.velocity()[1](size_t(8.5 * cells), size_t(8.2 * cells), 0);
    if (before < 0 && v >= 0) times.push_back(p.frame * (f - v / (v - before)));
    before = v;
  }
  REQUIRE(times.size() > 6);
  const double period = (times.back() - times[times.size() - 5]) / 4;
  MESSAGE("Strouhal number " << 1 / period);
  CHECK(1 / period > 0.16);
  CHECK(1 / period < 0.17);
}
