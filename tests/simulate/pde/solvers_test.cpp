// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/solvers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "simulate/pde/modes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::pde;
using sg::test::pi;

namespace {

Room room_of(int size, int axes, const std::string& sides, const std::string& x1 = "") {
  RoomParams p;
  p.size = size, p.bounds = test::unit_box(axes), p.sides = sides, p.x1 = x1;
  return make_room(p, "test", 60, false, Context());
}

Values noise(std::array<size_t, 3> n, uint64_t seed) {
  Values v(n);
  std::mt19937_64 random(seed);
  for (double& x : v.values) x = double(random() >> 11) * 0x1p-53 - 0.5;
  return v;
}

// The factor by which the residual shrinks in the end.
double last_factor(const std::vector<double>& r, size_t over) { return std::pow(r.back() / r[r.size() - 1 - over], 1 / double(over)); }

SolveHistory run(const Room& room, Solver solver, int iterations, double tolerance, Values x, Values b, double shift = 0) {
  LinearSolver s({room.axes, shift, 1}, {solver, tolerance, iterations, {}}, "test");
  return s.solve(b, x, Context());
}

}  // namespace

TEST_CASE("pde: the modes of a line are eigenvectors of the second difference, with the discrete eigenvalues of each pair of sides") {
  const Context context;
  struct Kind {
    const char *lo, *hi;
  };
  for (const Kind kind : {Kind{"0", "0"}, Kind{"insulated", "insulated"}, Kind{"0", "insulated"}, Kind{"periodic", "periodic"}})
    for (const size_t k : {1, 2, 5}) {
      const Room room = room_of(12, 1, kind.lo, kind.hi);
      const Axis& axis = room.axes[0];
      const double n = double(axis.n), h = axis.h(), m = double(k);
      const bool held = axis.lo.wall(), both = axis.hi.wall(), periodic = axis.lo.kind == SideKind::periodic;
      const double angle = held && both ? m * pi / (2 * (n + 1))
                           : held       ? (2 * m - 1) * pi / (2 * (2 * n + 1))
                           : periodic   ? m * pi / n
                                        : m * pi / (2 * n);
      const double eigenvalue = 4 / (h * h) * std::pow(std::sin(angle), 2);
      Values u(room.n()), out(room.n());
      for (size_t i = 0; i < axis.n; ++i) {
        const double x = axis.first() + double(i) * h;
        u.values[i] = held && both ? std::sin(m * pi * x)
                      : held       ? std::sin((m - 0.5) * pi * x)
                      : periodic   ? std::cos(2 * m * pi * x)
                                   : std::cos(m * pi * x);
      }
      Operator{room.axes, 0, 1}.apply(u, out, context);
      CAPTURE(kind.lo);
      for (size_t i = 0; i < axis.n; ++i) CHECK(out.values[i] == doctest::Approx(eigenvalue * u.values[i]).epsilon(1e-10));
      if (k == 1) CHECK(axis.least_eigenvalue() == doctest::Approx(eigenvalue).epsilon(1e-12));
    }
}

TEST_CASE("pde: Jacobi's factor is cos(pi/(n+1)), that of Gauss-Seidel its square, and the best omega 2/(1+sin(pi/(n+1)))") {
  const Room room = room_of(64, 2, "0");
  REQUIRE(room.axes[0].n == 63);
  const double rho = std::cos(pi / 64);
  CHECK(rho == doctest::Approx(0.9987955).epsilon(1e-7));
  const Values b(room.n(), 1), x(room.n());
  CHECK(last_factor(run(room, Solver::jacobi, 3000, 0, x, b).residuals, 100) == doctest::Approx(rho).epsilon(1e-7));
  CHECK(last_factor(run(room, Solver::gauss_seidel, 3000, 0, x, b).residuals, 100) == doctest::Approx(rho * rho).epsilon(1e-7));
  const Operator op{room.axes, 0, 1};
  CHECK(op.best_omega() == doctest::Approx(1.906455).epsilon(1e-6));
  // At the best omega all eigenvalues have the size omega - 1 (Young 1954).
  CHECK(last_factor(run(room, Solver::sor, 250, 0, x, b).residuals, 150) == doctest::Approx(op.best_omega() - 1).epsilon(0.02));
  // Nearby omegas are slower.
  for (const double other : {1.85, 1.95}) {
    LinearSolver s({room.axes, 0, 1}, {Solver::sor, 1e-8, 10000, other}, "test");
    Values c = b, y = x;
    CHECK(s.solve(c, y, Context()).residuals.size() > run(room, Solver::sor, 10000, 1e-8, x, b).residuals.size());
  }
}

TEST_CASE("pde: multigrid needs as many cycles for any size, in 1, 2 and 3 dimensions and between any sides") {
  for (const char* sides : {"0", "insulated", "periodic"})
    for (const int axes : {1, 2, 3}) {
      size_t least = 1000, most = 0;
      const std::vector<int> sizes = axes == 3 ? std::vector<int>{8, 16, 32, 50} : std::vector<int>{16, 64, 100, 256};
      for (const int size : sizes) {
        const Room room = room_of(size, axes, sides);
        Values b = noise(room.n(), 3);
        double mean = 0;
        for (const double v : b.values) mean += v / double(b.values.size());
        for (double& v : b.values) v -= mean;
        const SolveHistory h = run(room, Solver::multigrid, 100, 1e-8, Values(room.n()), b);
        CHECK(h.reached);
        least = std::min(least, h.residuals.size() - 1), most = std::max(most, h.residuals.size() - 1);
      }
      CAPTURE(std::string(sides));
      CAPTURE(axes);
      CAPTURE(least);
      CHECK(most <= 14);
      CHECK(most <= std::max<size_t>(least + 3, 8));  // with nested grids a line takes one
    }
  // Held on one side, insulated on the others; odd shapes.
  RoomParams p;
  p.size = 90, p.bounds = {0, 3, 0, 1, 0, 0.2}, p.x0 = "0";
  const Room room = make_room(p, "test", 60, false, Context());
  CHECK(run(room, Solver::multigrid, 15, 1e-8, Values(room.n()), noise(room.n(), 5)).reached);
}

TEST_CASE("pde: all solvers reach the same solution") {
  const Room room = room_of(20, 2, "0", "insulated");
  Values exact = noise(room.n(), 1), b(room.n());
  Operator{room.axes, 3, 1}.apply(exact, b, Context());
  for (const auto& word : enum_words(Solver{})) {
    CAPTURE(word.word);
    LinearSolver s({room.axes, 3, 1}, {word.value, 1e-12, 20000, {}}, "test");
    Values c = b, x(room.n());
    CHECK(s.solve(c, x, Context()).reached);
    for (size_t i = 0; i < x.values.size(); i += 7) CHECK(x.values[i] == doctest::Approx(exact.values[i]).epsilon(1e-8));
  }
}

TEST_CASE("pde: solvers give the same bytes on one thread and on several") {
  for (const auto& word : enum_words(Solver{})) {
    const Room room = room_of(40, 3, "0", "insulated");
    const auto bytes = [&](int threads) {
      set_thread_count(threads);
      LinearSolver s({room.axes, 0, 1}, {word.value, 1e-9, 12, {}}, "test");
      Values b = noise(room.n(), 9), x(room.n());
      s.solve(b, x, Context());
      set_thread_count(0);
      return x.values;
    };
    CAPTURE(word.word);
    CHECK(bytes(1) == bytes(5));
  }
}

TEST_CASE("pde: an omega that diverges is told, and so is a source that nothing can carry off") {
  const Room room = room_of(16, 2, "0"), closed = room_of(16, 2, "insulated");
  LinearSolver wild({room.axes, 0, 1}, {Solver::sor, 1e-8, 100000, 2.5}, "test");
  Values b(room.n(), 1), x(room.n());
  CHECK(test::contains(test::error_of([&] { wild.solve(b, x, Context()); }), "beyond all numbers after"));
  Values one(closed.n(), 1);
  CHECK(test::contains(test::error_of([&] { run(closed, Solver::cg, 100, 1e-8, Values(closed.n()), one); }), "no solution"));
}
