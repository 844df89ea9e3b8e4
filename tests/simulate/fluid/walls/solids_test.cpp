// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/walls/solids.h"

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "simulate/fluid/pressure/project.h"
#include "simulate/fluid/smoke.h"
#include "support/test.h"

using namespace sg;
using namespace sg::fluid;

namespace {

using std::numbers::pi;

// The surface of a box, twelve triangles.
TriangleSoup box_surface(Vec3 lo, Vec3 hi) {
  TriangleSoup soup;
  const auto corner = [&](int c) { return Vec3(c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z); };
  for (const auto& q : {std::array{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}})
    for (const int c : {q[0], q[1], q[2], q[0], q[2], q[3]}) soup.push_back(corner(c));
  return soup;
}

// A sphere of 2 n^2 triangles.
TriangleSoup sphere_surface(Vec3 middle, double radius, int n) {
  TriangleSoup soup;
  const auto at = [&](int i, int j) {
    const double th = pi * i / n, ph = 2 * pi * j / n;
    return middle + radius * Vec3(std::sin(th) * std::cos(ph), std::sin(th) * std::sin(ph), std::cos(th));
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (const Vec3& p : {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)}) soup.push_back(p);
  return soup;
}

double sum(const Lattice<double>& l) {
  double s = 0;
  for (const double v : l.values) s += v;
  return s;
}

}  // namespace

TEST_CASE("fluid solids: shares inside of a box are its overlap with cells and faces") {
  Context context;
  const MacGrid g{{10, 8, 6}, 0.1, {1, 2, 3}};
  // From 0.25 to 0.6 of a box that begins at the grid's origin: half of cell 2, all of 3, 4, 5.
  const TriangleSoup soup = box_surface({1.25, 2.2, 3.1}, {1.6, 2.5, 3.4});
  const Lattice<double> cells = shares_inside<double>(soup, g, -1, context), faces = shares_inside<double>(soup, g, 0, context);
  CHECK(sum(cells) == doctest::Approx(3.5 * 3 * 3).epsilon(1e-9));
  CHECK(cells(2, 3, 2) == doctest::Approx(0.5));
  CHECK(cells(4, 3, 2) == doctest::Approx(1));
  CHECK(cells(6, 3, 2) == doctest::Approx(0).scale(1));
  CHECK(faces(3, 3, 2) == doctest::Approx(1));
  CHECK(faces(2, 3, 2) == 0);
  CHECK(faces(3, 5, 2) == doctest::Approx(0).scale(1));
}

TEST_CASE("fluid solids: shares of a sphere sum up to its volume, to second order") {
  Context context;
  const auto miss = [&](size_t n) {
    const MacGrid g{{n, n, n}, 1.0 / double(n), {}};
    const Lattice<double> cells = shares_inside<double>(sphere_surface({0.51, 0.48, 0.5}, 0.3, 400), g, -1, context);
    for (const double v : cells.values) CHECK(v <= 1 + 1e-12);
    return std::abs(sum(cells) * g.h * g.h * g.h / (4 * pi / 3 * 0.027) - 1);
  };
  CHECK(miss(16) < 2e-3);
  CHECK(miss(48) < 3e-4);
}

TEST_CASE("fluid solids: a piston pushes out what it sweeps, and the flow round a moving ball has no divergence") {
  Context context;
  SmokeParams p;
  p.type = FieldType::f64, p.size = 24, p.bounds = {0, 1, 0, 1, 0, 1};
  p.obstacle = {0.5, 0.5, 0.5, 0.2}, p.obstacle_velocity = {0.3, 0.1, -0.2}, p.obstacle_spin = {0, 0, 2};
  const MacGrid g = smoke_grid(p, context);
  Sides sides{};
  sides[5].kind = SideKind::open, sides[0] = {SideKind::inflow, {0.4, 0, 0}};
  const Solids solids(p, {}, g);
  CHECK(solids.move());
  CHECK(solids.speed() > length(p.obstacle_velocity));
  Projection<double> projection(g, solids.walls<double>(sides, 0, context));
  Faces<double> u = make_faces<double>(g);
  Lattice<double> pressure(g.cells), left(g.cells);
  std::array<Lattice<double>, 5> spare;
  CHECK(projection.apply(u, pressure, 1e-10, spare, context).residual <= 1e-10);
  projection.divergence(u, left, context);
  double most = 0;
  for (const double v : left.values) most = std::max(most, std::abs(v));
  CHECK(most < 1e-9);
  // What comes in at x0 leaves at z1; the ball takes as much room as it leaves.
  double in = 0, out = 0;
  for (size_t k = 0; k < 24; ++k)
    for (size_t j = 0; j < 24; ++j) in += u[0](0, j, k), out += u[2](j, k, 24);
  CHECK(in == doctest::Approx(24 * 24 * 0.4));
  CHECK(out == doctest::Approx(in).epsilon(1e-7));
  CHECK(u[0](12, 12, 12) == doctest::Approx(0.3 - 2 * (12.5 / 24 - 0.5)));  // the spin takes its part
  CHECK(u[2](12, 12, 12) == doctest::Approx(-0.2));
}

TEST_CASE("fluid solids: after a turn a body is where it was, and halfway its velocity points back") {
  Context context;
  SmokeParams p;
  p.type = FieldType::f64, p.size = 32, p.bounds = {0, 1, 0, 1, 0, 0};
  p.obstacle = {0.35, 0.5, 0, 0.1, 0.65, 0.5, 0, 0.1}, p.obstacle_spin = {0, 0, 2 * pi};
  const MacGrid g = smoke_grid(p, context);
  const Solids solids(p, {}, g);
  const auto start = solids.walls<double>({}, 0, context), half = solids.walls<double>({}, 0.5, context),
             quarter = solids.walls<double>({}, 0.25, context);
  for (size_t i = 0; i < start.open[0].values.size(); ++i)
    CHECK(start.open[0].values[i] == doctest::Approx(half.open[0].values[i]).scale(1));
  CHECK(start.open[0](11, 16, 0) == 0);
  CHECK(quarter.open[0](11, 16, 0) == 1);
  CHECK(quarter.open[1](16, 11, 0) == 0);
}

TEST_CASE("fluid solids: bad sides, boxes and obstacles are told apart") {
  Context context;
  const auto refuses = [&](auto&& change, const char* words) {
    SmokeParams p;
    p.size = 8;
    change(p);
    CHECK_THROWS_WITH_AS(smoke(p, context), doctest::Contains(words), Error);
  };
  refuses([](SmokeParams& p) { p.sides = "w0 open"; }, "no side of a box");
  refuses([](SmokeParams& p) { p.sides = "x0 opne"; }, "does not say what lies at x0");
  refuses([](SmokeParams& p) { p.sides = "x0"; }, "does not say what lies at x0");
  refuses([](SmokeParams& p) { p.sides = "x0 inflow 1,0"; }, "three numbers");
  refuses([](SmokeParams& p) { p.sides = "x0 inflow 1,0,nan"; }, "three numbers");
  refuses([](SmokeParams& p) { p.sides = "x0 open 1,0,0"; }, "no velocity of its own");
  refuses([](SmokeParams& p) { p.sides = "x0 held 1,0,0"; }, "out of its plane");
  refuses([](SmokeParams& p) { p.obstacle = {0.5, 0.5, 1, 9}; }, "nothing is left");
  refuses([](SmokeParams& p) { p.box = {0, 1, 0, 1}; }, "no boxes");
  refuses([](SmokeParams& p) { p.box = {0.5, 0.4, 0, 1, 0, 1}; }, "from 0.5 to 0.4");
  refuses([](SmokeParams& p) { p.box = {5, 6, 0, 1, 0, 1}; }, "outside of the air");
  refuses([](SmokeParams& p) { p.open = BoxSide::none, p.sides = "x0 inflow 1,0,0", p.time = 0.04; }, "cannot flow out");
}

TEST_CASE("smoke: sources give off at a rate, and mass in a closed box without flow stays") {
  Context context;
  SmokeParams p;
  p.type = FieldType::f64, p.size = 20, p.bounds = {0, 1, 0, 1, 0, 0}, p.open = BoxSide::none, p.temperature = 0, p.weight = 0;
  p.box = {0.2, 0.4, 0.3, 0.6, 0, 0}, p.density = 3, p.rate = 2, p.frame = 0.5;
  Smoke<double> run(p, {}, context);
  CHECK(sum(run.density()) == 0);
  run.advance(context);
  // rate * density * area * time, in cells.
  CHECK(sum(run.density()) == doctest::Approx(2 * 3 * (0.2 * 0.3) * 0.5 * 400).epsilon(1e-9));
}

TEST_CASE("smoke: a body of triangles flows round like the ball that it is") {
  Context context;
  SmokeParams p;
  p.type = FieldType::f64, p.size = 32, p.bounds = {0, 1, 0, 1, 0, 1}, p.density = p.temperature = 0, p.frame = 0.1;
  p.sides = "z0 inflow 0,0,1; z1 open";
  SmokeParams with_ball = p;
  with_ball.obstacle = {0.5, 0.5, 0.5, 0.2};
  Smoke<double> a(p, {sphere_surface({0.5, 0.5, 0.5}, 0.2, 60), SurfaceRole::obstacle, {}, {}, {}}, context), b(with_ball, {}, context);
  a.advance(context), b.advance(context);
  double miss = 0;
  for (size_t i = 0; i < a.velocity()[2].values.size(); ++i) miss += std::abs(a.velocity()[2].values[i] - b.velocity()[2].values[i]);
  CHECK(miss / double(a.velocity()[2].values.size()) < 0.01);
  CHECK(a.velocity()[2](16, 16, 16) == 0);
  CHECK(b.velocity()[2](16, 16, 16) == 0);
}

TEST_CASE("smoke: the equator of a ball in potential flow has one and a half times the speed of the stream") {
  // One projection of a flow at rest with air coming in gives the flow without vorticity: u = U (1 + R^3 / (2 r^3)) beside the ball.
  Context context;
  const auto miss = [&](int n) {
    SmokeParams p;
    p.type = FieldType::f64, p.size = n, p.bounds = {0, 1, 0, 1, 0, 1}, p.density = p.temperature = 0, p.frame = 1e-6;
    p.sides = "z0 inflow 0,0,1; z1 open", p.obstacle = {0.5, 0.5, 0.5, 0.1};
    Smoke<double> run(p, {}, context);
    run.advance(context);
    double worst = 0;
    for (int i = int(0.68 * n); i < int(0.8 * n); ++i) {
      const double r = (i + 0.5) / n - 0.5, expected = 1 + 0.5 * std::pow(0.1 / r, 3);
      worst = std::max(worst, std::abs(run.velocity()[2](size_t(i), size_t(n / 2), size_t(n / 2)) - expected));
    }
    return worst;
  };
  CHECK(miss(40) < 0.04);  // the box narrows the stream by 3 %
}
