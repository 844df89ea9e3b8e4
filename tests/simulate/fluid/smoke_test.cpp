// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/smoke.h"

#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"
#include "base/parallel.h"
#include "simulate/fluid/forces.h"
#include "support/test.h"

using namespace sg;
using namespace sg::fluid;

namespace {

using std::numbers::pi;

double largest_of(const Lattice<double>& l) {
  double m = 0;
  for (const double v : l.values) m = std::max(m, std::abs(v));
  return m;
}

double largest_of(const Faces<double>& u) { return std::max({largest_of(u[0]), largest_of(u[1]), largest_of(u[2])}); }

Faces<double> noise_on(const MacGrid& g) {
  std::mt19937_64 random(5);
  Faces<double> u = make_faces<double>(g);
  for (auto& l : u)
    for (double& v : l.values) v = double(random() >> 11) * 0x1p-53 - 0.5;
  return u;
}

SmokeParams still(int size = 16) {
  SmokeParams p;
  p.size = size, p.type = FieldType::f64, p.density = p.temperature = 0, p.bounds = {0, 1, 0, 1, 0, 0}, p.open = BoxSide::none;
  return p;
}

}  // namespace

TEST_CASE("fluid projection: no divergence is left, and a second one changes nothing") {
  Context context;
  for (const MacGrid& g : {MacGrid{{24, 20, 16}, 0.1, {}}, MacGrid{{40, 28, 1}, 2, {1, 2, 3}}})
    for (const OpenSides& sides : {OpenSides{}, OpenSides{false, false, false, true, false, false}}) {
      Faces<double> open = make_faces<double>(g, 1);
      for (size_t k = 0; k < g.cells[2]; ++k)  // a solid block with a sloped share beside it
        for (size_t j = 5; j < 10; ++j)
          for (size_t i = 6; i <= 12; ++i) open[0](i, j, k) = i == 12 ? 0.3 : 0;
      Projection<double> projection(g, {sides, open, {}, {}});
      std::array<Lattice<double>, 5> spare;
      Faces<double> u = noise_on(g);
      Lattice<double> p(g.cells), left(g.cells);
      projection.divergence(u, left, context);
      const double before = largest_of(left);
      CHECK(projection.apply(u, p, 1e-10, spare, context).residual <= 1e-10);
      projection.divergence(u, left, context);
      CHECK(largest_of(left) <= 2e-10 * before);
      const Faces<double> once = u;
      projection.apply(u, p, 1e-10, spare, context);
      double change = 0;
      for (size_t a = 0; a < 3; ++a)
        for (size_t i = 0; i < u[a].values.size(); ++i) change = std::max(change, std::abs(u[a].values[i] - once[a].values[i]));
      CHECK(change < 1e-8);
      for (size_t k = 0; k < g.cells[2]; ++k) CHECK(u[0](8, 7, k) == 0);
    }
}

TEST_CASE("fluid projection: gradients vanish, and flows along stream lines stay") {
  Context context;
  const MacGrid g{{32, 32, 1}, 1.0 / 32, {}};
  Projection<double> projection(g, {});
  std::array<Lattice<double>, 5> spare;
  Faces<double> gradient = make_faces<double>(g), curl = make_faces<double>(g);
  const auto potential = [](double x, double y) { return std::cos(3 * pi * x) * std::cos(2 * pi * y); };
  const auto stream = [](double x, double y) { return std::sin(pi * x) * std::sin(2 * pi * y); };
  const double h = g.h;
  for (size_t j = 0; j < 32; ++j)
    for (size_t i = 1; i < 32; ++i) {
      const double x = double(i) * h, y = (double(j) + 0.5) * h;
      gradient[0](i, j, 0) = potential(x + h / 2, y) - potential(x - h / 2, y),
                        curl[0](i, j, 0) = stream(x, y + h / 2) - stream(x, y - h / 2);
      gradient[1](j, i, 0) = potential(y, x + h / 2) - potential(y, x - h / 2),
                        curl[1](j, i, 0) = stream(y - h / 2, x) - stream(y + h / 2, x);
    }
  Lattice<double> p(g.cells);
  projection.apply(gradient, p, 1e-12, spare, context);
  CHECK(largest_of(gradient) < 1e-11);
  const Faces<double> before = curl;
  Lattice<double> none(g.cells);
  projection.apply(curl, none, 1e-12, spare, context);
  for (size_t a = 0; a < 2; ++a)
    for (size_t i = 0; i < curl[a].values.size(); ++i)
      CHECK(curl[a].values[i] == doctest::Approx(before[a].values[i]).scale(1).epsilon(1e-12));
}

TEST_CASE("smoke: without forces, air at rest stays at rest; evenly heavy air does, too") {
  Context context;
  SmokeParams p = still();
  p.density = p.temperature = 1, p.lift = p.weight = 0;
  Smoke<double> rest(p, {}, context);
  const auto density = rest.density().values;
  for (int i = 0; i < 3; ++i) rest.advance(context);
  CHECK(largest_of(rest.velocity()) == 0);
  CHECK(rest.density().values == density);
  p = still();
  p.density = 1, p.weight = 5, p.lift = 0, p.tolerance = 1e-12;
  Smoke<double> column(p, {}, context);
  std::fill(column.density().values.begin(), column.density().values.end(), 1.0);
  for (int i = 0; i < 3; ++i) column.advance(context);
  CHECK(largest_of(column.velocity()) < 1e-12);
}

TEST_CASE("smoke: hot air beside a source that holds its temperature stays hot") {
  Context context;
  SmokeParams p = still();
  p.temperature = 3, p.lift = p.weight = 0, p.source = {0.5, 0.5, 0, 0.2}, p.box = {0.1, 0.2, 0.1, 0.2, 0, 0};
  Smoke<double> s(p, {}, context);
  for (double& v : s.temperature().values) v = std::max(v, 1.0);
  s.advance(context);
  double least = HUGE_VAL;
  for (const double v : s.temperature().values) least = std::min(least, v);
  CHECK(least == doctest::Approx(1));
}

TEST_CASE("smoke: Taylor-Green vortices decay as viscosity says, the better the finer the grid") {
  // u = (sin(pi x) cos(pi y), -cos(pi x) sin(pi y)): between walls along which it slips its energy is 1/4 exp(-4 nu pi^2 t).
  Context context;
  const double viscosity = 0.02, time = 0.4;
  const auto miss = [&](int n, Advection scheme, bool reflect = false) {
    SmokeParams p = still(n);
    p.reflect = reflect, p.limit = false;
    p.viscosity = viscosity, p.frame = time, p.cfl = 0.5, p.advection = scheme, p.tolerance = 1e-10;
    Smoke<double> air(p, {}, context);
    auto& u = air.velocity();
    for (size_t j = 0; j < size_t(n); ++j)
      for (size_t i = 0; i <= size_t(n); ++i) {
        const double x = double(i) / n, y = (double(j) + 0.5) / n;
        u[0](i, j, 0) = std::sin(pi * x) * std::cos(pi * y), u[1](j, i, 0) = -std::cos(pi * y) * std::sin(pi * x);
      }
    air.advance(context);
    double energy = 0;
    for (int a = 0; a < 2; ++a)
      for (const double v : u[size_t(a)].values) energy += v * v / 2 / n / n;
    return std::abs(energy / (0.25 * std::exp(-4 * viscosity * pi * pi * time)) - 1);
  };
  const double coarse = miss(16, Advection::maccormack), fine = miss(32, Advection::maccormack), finest = miss(64, Advection::maccormack);
  CHECK(finest < 0.02);
  CHECK(std::log2(coarse / fine) > 0.8);
  CHECK(std::log2(fine / finest) > 0.8);
  CHECK(miss(32, Advection::semi_lagrangian) > 2 * fine);
  std::vector<double> reflected;
  for (const int n : {16, 32, 64}) reflected.push_back(miss(n, Advection::maccormack, true));
  MESSAGE("energy too small by " << coarse << ", " << fine << ", " << finest << "; reflected " << reflected[0] << ", " << reflected[1]
                                 << ", " << reflected[2]);
  CHECK(std::log2(reflected[0] / reflected[1]) > 1.5);
  CHECK(std::log2(reflected[1] / reflected[2]) > 1.7);
  CHECK(reflected[2] < finest / 50);
}

TEST_CASE("smoke: friction takes from a wave what the implicit step says") {
  Context context;
  const MacGrid g{{20, 20, 1}, 0.05, {}};
  Faces<double> u = make_faces<double>(g);
  Walls<double> walls;
  walls.open = make_faces<double>(g, 1);
  walls.close_sides();
  std::array<Lattice<double>, 5> spare;
  for (size_t j = 0; j < 20; ++j)
    for (size_t i = 0; i <= 20; ++i) u[0](i, j, 0) = std::sin(pi * double(i) / 20) * std::cos(pi * (double(j) + 0.5) / 20);
  const Faces<double> before = u;
  const double viscosity = 0.3, dt = 0.1;
  diffuse_velocity<double>(g, walls, Sides{}, viscosity, dt, u, spare, context);
  const double eigenvalue = 2 * 4 * std::pow(std::sin(pi / 40) / g.h, 2);
  for (size_t i = 0; i < u[0].values.size(); ++i)
    CHECK(u[0].values[i] == doctest::Approx(before[0].values[i] / (1 + dt * viscosity * eigenvalue)).scale(1).epsilon(1e-10));
}

TEST_CASE("smoke: a plume rises, stays between the values that it was given, and its mirror image is itself") {
  Context context;
  SmokeParams p;
  p.size = 32, p.frame = 0.2, p.type = FieldType::f64, p.lift = 4;
  for (const Advection scheme : {Advection::semi_lagrangian, Advection::maccormack, Advection::bfecc}) {
    p.advection = scheme, p.time = 1;
    const DatasetPtr d = smoke(p, context);
    CHECK(d->time() == doctest::Approx(1.0));
    const auto& g = *d->as<UniformGrid>();
    CHECK(g.dims == std::array<size_t, 3>{16, 16, 32});
    const auto density = d->fields().require("density").array.view<double>();
    double height = 0, mass = 0, most = 0, least = 1, uneven = 0;
    for (size_t k = 0; k < 32; ++k)
      for (size_t j = 0; j < 16; ++j)
        for (size_t i = 0; i < 16; ++i) {
          const double v = density[i + 16 * (j + 16 * k)];
          height += v * double(k) / 16, mass += v, most = std::max(most, v), least = std::min(least, v);
          uneven = std::max(uneven, std::abs(v - density[15 - i + 16 * (j + 16 * k)]));
        }
    CHECK(height / mass > 0.3);  // begins at 0.18
    CHECK(most <= 1);
    CHECK(least >= 0);
    CHECK(uneven < 1e-3);
  }
}

TEST_CASE("smoke: the same bytes in any order of times and for any number of threads") {
  Context context;
  SmokeParams p;
  p.size = 20, p.frame = 0.1, p.obstacle = {0.5, 0.5, 1, 0.2};
  const auto at = [&](double time) {
    p.time = time;
    const DatasetPtr d = smoke(p, context);
    const auto v = d->fields().require("density").array.view<float>();
    std::vector<float> values(d->point_count());
    for (size_t i = 0; i < values.size(); ++i) values[i] = v[i];
    return values;
  };
  const auto third = at(0.3), fifth = at(0.5), third_again = at(0.3);
  CHECK(third == third_again);
  CHECK(third != fifth);
  set_thread_count(1);
  const auto alone = at(0.55);  // within the frame
  set_thread_count(0);
  CHECK(alone == fifth);
}

TEST_CASE("smoke: what cannot be computed is said") {
  Context context;
  const auto fails = [&](auto change, const char* word) {
    SmokeParams p;
    p.size = 12;
    change(p);
    CHECK_THROWS_WITH_AS(smoke(p, context), doctest::Contains(word), Error);
  };
  fails([](SmokeParams& p) { p.source = {5, 5, 5, 0.1}; }, "outside of the box");
  fails([](SmokeParams& p) { p.source = {0.5, 0.5, 0.5}; }, "no balls");
  fails([](SmokeParams& p) { p.bounds = {0, 0, 0, 1, 0, 1}; }, "box extends");
  fails([](SmokeParams& p) { p.up = Vec3(0, 0, 0); }, "no direction");
  fails([](SmokeParams& p) { p.time = 1e9; }, "million");
  fails([](SmokeParams& p) { p.lift = 1e12, p.time = 1; }, "frame 1");
  fails([](SmokeParams& p) { p.advection = Advection::explicit_euler, p.time = 60, p.lift = 5, p.frame = 0.5; }, "explicit");
}
