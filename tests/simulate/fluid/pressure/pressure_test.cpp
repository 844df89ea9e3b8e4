// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/pressure/pressure.h"

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "simulate/fluid/smoke.h"
#include "simulate/fluid/walls/solids.h"
#include "support/test.h"

using namespace sg;
using namespace sg::fluid;

namespace {

using std::numbers::pi;
constexpr OpenSides closed{}, all_open{true, true, true, true, true, true}, top_open{false, false, false, false, false, true};

MacGrid grid_of(std::array<size_t, 3> cells) { return {cells, 1, {}}; }

// Open shares about a solid ball in the middle: a face is open as far as its middle is from the ball, at most 1.
template <class T>
Walls<T> shares(const MacGrid& g, double radius, const OpenSides& sides) {
  Faces<T> open = make_faces<T>(g, 1);
  if (g.flat()) open[2] = Lattice<T>(g.faces(2), 0);
  for (int a = 0; a < g.axes(); ++a)
    for (size_t k = 0; k < open[size_t(a)].n[2]; ++k)
      for (size_t j = 0; j < open[size_t(a)].n[1]; ++j)
        for (size_t i = 0; i < open[size_t(a)].n[0]; ++i) {
          const auto s = MacGrid::shift(a);
          const Vec3 p = Vec3(double(i) + s[0], double(j) + s[1], g.flat() ? 0 : double(k) + s[2]) -
                         0.5 * Vec3(double(g.cells[0]), double(g.cells[1]), g.flat() ? 0 : double(g.cells[2]));
          open[size_t(a)](i, j, k) = T(std::clamp(length(p) - radius + 0.5, 0.0, 1.0));
        }
  return {sides, std::move(open), {}, {}};
}

template <class T>
Lattice<T> noise(std::array<size_t, 3> cells, uint64_t seed) {
  Lattice<T> v(cells);
  std::mt19937_64 random(seed);
  for (T& x : v.values) x = T(double(random() >> 11) * 0x1p-53 - 0.5);
  return v;
}

template <class T>
double dot(const Lattice<T>& a, const Lattice<T>& b) {
  double s = 0;
  for (size_t i = 0; i < a.values.size(); ++i) s += double(a.values[i]) * double(b.values[i]);
  return s;
}

// What a flow can ask for: A of something.
template <class T>
Lattice<T> reachable(std::array<size_t, 3> cells, const Walls<T>& walls, uint64_t seed = 7) {
  Context context;
  Lattice<T> b(cells);
  Multigrid<T>(cells, walls).apply(noise<T>(cells, seed), b, context);
  return b;
}

}  // namespace

TEST_CASE("fluid pressure: waves between walls and between open sides are eigenvectors") {
  Context context;
  const size_t n = 12;
  for (const bool open : {false, true}) {
    Multigrid<double> grid({n, n, n}, shares<double>(grid_of({n, n, n}), -1e9, open ? all_open : closed));
    const std::array<int, 3> waves{1, 3, 5};
    Lattice<double> x({n, n, n}), y({n, n, n});
    double eigenvalue = 0;
    for (const int k : waves) eigenvalue += 4 * std::pow(std::sin(pi * k / (2.0 * n)), 2);
    const auto wave = [&](size_t i, int k) {
      const double a = pi * k * (double(i) + 0.5) / n;
      return open ? std::sin(a) : std::cos(a);
    };
    for (size_t k = 0; k < n; ++k)
      for (size_t j = 0; j < n; ++j)
        for (size_t i = 0; i < n; ++i) x(i, j, k) = wave(i, waves[0]) * wave(j, waves[1]) * wave(k, waves[2]);
    grid.apply(x, y, context);
    double miss = 0;
    for (size_t i = 0; i < x.values.size(); ++i) miss = std::max(miss, std::abs(y.values[i] - eigenvalue * x.values[i]));
    CHECK(miss < 1e-12);
  }
}

TEST_CASE("fluid pressure: the cycle is symmetric and positive") {
  Context context;
  for (const std::array<size_t, 3> cells : {std::array<size_t, 3>{17, 12, 9}, {32, 32, 1}, {5, 40, 3}})
    for (const OpenSides& sides : {top_open, all_open}) {
      const MacGrid g = grid_of(cells);
      Multigrid<double> grid(cells, shares<double>(g, 3, sides));
      // Dry cells have no part in what is asked.
      const Lattice<double> x = reachable(cells, shares<double>(g, 3, sides)), y = reachable(cells, shares<double>(g, 3, sides), 2);
      Lattice<double> mx(cells), my(cells), spare(cells);
      grid.precondition(x, mx, spare, context), grid.precondition(y, my, spare, context);
      CHECK(dot(y, mx) == doctest::Approx(dot(x, my)).epsilon(1e-10));
      CHECK(dot(x, mx) > 0);
    }
}

TEST_CASE("fluid pressure: the number of iterations hardly grows with the grid") {
  Context context;
  for (const OpenSides& sides : {closed, top_open, all_open})
    for (const double radius : {-1e9, 0.15})
      for (const size_t n : {16u, 32u, 64u}) {
        const std::array<size_t, 3> cells{n, n, n};
        const Walls<float> walls = shares<float>(grid_of(cells), radius * double(n), sides);
        PressureSolver<float> solver(cells, walls);
        Lattice<float> b = reachable(cells, walls), p(cells);
        std::array<Lattice<float>, 4> spare;
        const SolveReport report = solver.solve(b, p, 1e-5, spare, context);
        INFO("n " << n << ", radius " << radius << ", open sides " << int(sides[0]) + int(sides[5]));
        CHECK(report.residual <= 1e-5);
        CHECK(report.iterations < 15);
      }
}

TEST_CASE("fluid pressure: balls that cut cells anyhow cost hardly any iterations") {
  Context context;
  for (const int size : {32, 50, 64})
    for (const double radius : {0.1, 0.22, 0.33})
      for (const double off : {0.0, 0.013}) {
        SmokeParams params;
        params.size = size, params.bounds = {0, 1, 0, 1, 0, 1}, params.obstacle = {0.5 + off, 0.5, 0.6, radius};
        const MacGrid g = smoke_grid(params, context);
        const auto walls = Solids(params, {}, g).walls<float>(sides_of(params, g, Vec3(0, 0, 1)), 0, context);
        PressureSolver<float> solver(g.cells, walls);
        Lattice<float> b = reachable<float>(g.cells, walls), p(g.cells);
        std::array<Lattice<float>, 4> spare;
        CAPTURE(size);
        CAPTURE(radius);
        CHECK(solver.solve(b, p, 1e-5, spare, context).iterations <= 14);
      }
}

TEST_CASE("fluid pressure: the solution is the one that was put in, up to a constant of each closed room") {
  Context context;
  const std::array<size_t, 3> cells{20, 14, 11};
  for (const bool sealed : {true, false}) {
    Walls<double> walls = shares<double>(grid_of(cells), -1e9, {false, !sealed, false, false, false, false});
    for (size_t k = 0; k < 11; ++k)
      for (size_t j = 0; j < 14; ++j) walls.open[0](9, j, k) = 0;  // a wall across the box
    std::array<Lattice<double>, 4> spare;
    PressureSolver<double> solver(cells, walls);
    CHECK(solver.closed_rooms() == (sealed ? 2 : 1));
    Lattice<double> truth = noise<double>(cells, 3), b(cells), p(cells);
    Multigrid<double>(cells, walls).apply(truth, b, context);
    const SolveReport report = solver.solve(b, p, 1e-11, spare, context);
    CHECK(report.residual <= 1e-11);
    double shift[2] = {}, count[2] = {};
    const auto room = [&](size_t c) { return size_t(c % 20 >= 9); };
    for (size_t c = 0; c < p.values.size(); ++c) shift[room(c)] += truth.values[c], ++count[room(c)];
    if (!sealed) shift[1] = 0;
    double miss = 0;
    for (size_t c = 0; c < p.values.size(); ++c)
      miss = std::max(miss, std::abs(p.values[c] - truth.values[c] + shift[room(c)] / count[room(c)]));
    CHECK(miss < 1e-8);
  }
}

TEST_CASE("fluid pressure: what flows into a closed room is an error, and so are values that are no numbers") {
  Context context;
  const std::array<size_t, 3> cells{8, 8, 8};
  PressureSolver<double> solver(cells, shares<double>(grid_of(cells), -1e9, closed));
  Lattice<double> b(cells), p(cells);
  std::array<Lattice<double>, 4> spare;
  b(2, 3, 4) = 1;
  CHECK_THROWS_WITH_AS(solver.solve(b, p, 1e-6, spare, context), doctest::Contains("cannot flow out"), Error);
  b(5, 5, 5) = -1;
  CHECK(solver.solve(b, p, 1e-6, spare, context).residual <= 1e-6);
  b(1, 1, 1) = NAN;
  CHECK_THROWS_AS(solver.solve(b, p, 1e-6, spare, context), Error);
}

TEST_CASE("fluid pressure: the same bytes for any number of threads") {
  Context context;
  const std::array<size_t, 3> cells{40, 30, 20};
  const Walls<float> walls = shares<float>(grid_of(cells), 6, top_open);
  const auto solved = [&](int threads) {
    set_thread_count(threads);
    PressureSolver<float> solver(cells, walls);
    Lattice<float> b = reachable(cells, walls), p(cells);
    std::array<Lattice<float>, 4> spare;
    solver.solve(b, p, 1e-5, spare, context);
    return p.values;
  };
  const auto one = solved(1), three = solved(3);
  set_thread_count(0);
  CHECK(one == three);
}

TEST_CASE("fluid pressure: a box without obstacles is one whose faces are all open") {
  Context context;
  for (const std::array<size_t, 3> cells : {std::array<size_t, 3>{17, 12, 9}, {32, 20, 1}, {2, 2, 2}}) {
    OpenSides sides = top_open;
    if (cells[2] == 1) sides = {false, true, false, false, false, false};
    const Lattice<double> x = noise<double>(cells, 11);
    std::array<Lattice<double>, 3> results[2];
    for (const bool listed : {false, true}) {
      Walls<double> walls;
      walls.sides = sides;
      if (listed) walls.open = make_faces<double>(grid_of(cells), 1);
      Multigrid<double> grid(cells, walls);
      for (Lattice<double>& l : results[listed]) l = Lattice<double>(cells);
      grid.apply(x, results[listed][0], context);
      grid.precondition(results[listed][0], results[listed][1], results[listed][2], context);
    }
    for (const size_t r : {0u, 1u}) CHECK(results[0][r].values == results[1][r].values);
  }
}
