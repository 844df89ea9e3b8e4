// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/advection/advect.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "support/test.h"

using namespace sg;
using namespace sg::fluid;

namespace {

using std::numbers::pi;

template <class F>
void fill_cells(const MacGrid& g, Lattice<double>& l, F&& f) {
  for (size_t k = 0; k < l.n[2]; ++k)
    for (size_t j = 0; j < l.n[1]; ++j)
      for (size_t i = 0; i < l.n[0]; ++i)
        l(i, j, k) = f(g.origin + g.h * Vec3(double(i) + 0.5, double(j) + 0.5, g.flat() ? 0 : double(k) + 0.5));
}

// The velocity v(x) on the faces of a flat grid.
template <class F>
Faces<double> flow(const MacGrid& g, F&& v) {
  Faces<double> u = make_faces<double>(g);
  for (int a = 0; a < g.axes(); ++a) {
    auto& l = u[size_t(a)];
    const auto s = MacGrid::shift(a);
    for (size_t k = 0; k < l.n[2]; ++k)
      for (size_t j = 0; j < l.n[1]; ++j)
        for (size_t i = 0; i < l.n[0]; ++i)
          l(i, j, k) = v(g.origin + g.h * Vec3(double(i) + s[0], double(j) + s[1], g.flat() ? 0 : double(k) + s[2]))[a];
  }
  return u;
}

void carry(const Carrier<double>& step, int axis, const Lattice<double>& f, Lattice<double>& out) {
  Context context;
  Lattice<double> scratch(f.n), marks(f.n);
  const Carried<double> field{&f, &out, &scratch};
  advect<double>(step, axis, {&field, 1}, marks, context);
}

// Unit square, turned once about its middle.
Vec3 turning(Vec3 p) { return 2 * pi * Vec3(0.5 - p.y, p.x - 0.5, 0); }

struct Turned {
  double worst = 0, mean = 0, area = 0;
};

template <class F>
Turned turn(size_t n, Advection scheme, bool limit, F&& f, double cfl = 1.5) {
  Context context;
  const MacGrid g{{n, n, 1}, 1.0 / double(n), {}};
  const Faces<double> u = flow(g, turning);
  Lattice<double> now(g.cells), next(g.cells), first(g.cells);
  fill_cells(g, now, f);
  first = now;
  const size_t steps = size_t(std::ceil(2 * pi * 0.5 / (cfl * g.h)));
  const Carrier<double> step{g, u, 1.0 / double(steps), scheme, BackTrace::rk3, limit};
  for (size_t s = 0; s < steps; ++s) carry(step, -1, now, next), std::swap(now, next);
  Turned r;
  for (size_t c = 0; c < now.values.size(); ++c) {
    const double miss = std::abs(now.values[c] - first.values[c]);
    r.worst = std::max(r.worst, miss), r.mean += miss * g.h * g.h, r.area += (now.values[c] > 0.5) * g.h * g.h;
  }
  return r;
}

double hill(Vec3 p) {
  const double r = length(p - Vec3(0.5, 0.7, 0)) / 0.2;
  return r < 1 ? std::pow(std::cos(pi * r / 2), 4) : 0;
}

// A disc of radius 0.15 with a slot of 0.05 x 0.25 (Zalesak 1979).
double slotted(Vec3 p) { return length(p - Vec3(0.5, 0.75, 0)) < 0.15 && !(std::abs(p.x - 0.5) < 0.025 && p.y < 0.85); }

}  // namespace

TEST_CASE("advection: whole cells are moved exactly") {
  Context context;
  const MacGrid g{{12, 9, 7}, 0.5, {1, 2, 3}};
  const Faces<double> u = flow(g, [](Vec3) { return Vec3(1, -0.5, 0.5); });
  for (const Advection scheme : {Advection::semi_lagrangian, Advection::maccormack, Advection::bfecc})
    for (const BackTrace trace : {BackTrace::euler, BackTrace::rk2, BackTrace::rk3}) {
      Lattice<double> f(g.cells), out(g.cells);
      fill_cells(g, f, [](Vec3 p) { return std::sin(3 * p.x) + p.y * p.z; });
      carry({g, u, 1.0, scheme, trace, true}, -1, f, out);  // by 2, -1 and 1 cells
      for (size_t k = 2; k < 5; ++k)
        for (size_t j = 2; j < 6; ++j)
          for (size_t i = 3; i < 9; ++i) CHECK(out(i, j, k) == doctest::Approx(f(i - 2, j + 1, k - 1)).epsilon(1e-12));
    }
}

TEST_CASE("advection: waves shrink by semi-Lagrangian steps as the closed form says") {
  // Linear interpolation at the share a between two cells multiplies exp(i th x) by 1 - a + a exp(-i th).
  Context context;
  const size_t n = 48;
  const MacGrid g{{n, 1, 1}, 1, {}};
  for (const double a : {0.25, 0.5, 0.9}) {
    const Faces<double> u = flow(g, [&](Vec3) { return Vec3(a, 0, 0); });
    const double th = 2 * pi / 8;
    Lattice<double> f(g.cells), out(g.cells);
    fill_cells(g, f, [&](Vec3 p) { return std::cos(th * p.x); });
    carry({g, u, 1.0, Advection::semi_lagrangian, BackTrace::euler, true}, -1, f, out);
    const std::complex<double> factor = 1 - a + a * std::exp(std::complex<double>(0, -th));
    CHECK(std::abs(factor) == doctest::Approx(std::sqrt(1 - 2 * a * (1 - a) * (1 - std::cos(th)))));
    for (size_t i = 4; i < n - 4; ++i) {
      const std::complex<double> wave = factor * std::exp(std::complex<double>(0, th * (double(i) + 0.5)));
      CHECK(out(i, 0, 0) == doctest::Approx(wave.real()).epsilon(1e-10));
    }
  }
}

TEST_CASE("advection: orders of a smooth hill after a turn") {
  const auto order = [](Advection scheme) {
    std::vector<double> e;
    for (const size_t n : {64u, 128u, 256u}) e.push_back(turn(n, scheme, false, hill).mean);
    return std::log2(e[1] / e[2]);
  };
  CHECK(order(Advection::semi_lagrangian) > 0.7);
  CHECK(order(Advection::semi_lagrangian) < 1.1);
  CHECK(order(Advection::maccormack) > 1.9);
  CHECK(order(Advection::bfecc) > 1.9);
}

TEST_CASE("advection: Zalesak's disc after a turn, and no value beyond those that were there") {
  const double area = 0.0582207;  // pi r^2 less the slot
  CHECK(turn(200, Advection::maccormack, true, slotted).area == doctest::Approx(area).epsilon(0.03));
  const double dissolved = turn(100, Advection::semi_lagrangian, true, slotted).mean;
  for (const Advection scheme : {Advection::semi_lagrangian, Advection::maccormack, Advection::bfecc}) {
    const Turned r = turn(100, scheme, true, slotted);
    MESSAGE(word_of(scheme) << ", 100^2 cells: area " << r.area / area << " of the disc's, L1 error " << r.mean / area << " of it");
    CHECK(r.worst <= 1);
    if (scheme != Advection::semi_lagrangian) CHECK(r.mean < 0.75 * dissolved);
  }
}

TEST_CASE("advection: the explicit scheme blows up") {
  const Turned r = turn(48, Advection::explicit_euler, true, hill, 0.8);
  CHECK(r.worst > 10);
}

TEST_CASE("advection: constants stay, in velocity components as in cells") {
  Context context;
  const MacGrid g{{10, 11, 12}, 0.1, {}};
  const Faces<double> u = flow(g, [](Vec3 p) { return Vec3(std::sin(9 * p.y), std::cos(7 * p.z), std::sin(5 * p.x)); });
  for (int axis = -1; axis < 3; ++axis)
    for (const Advection scheme : {Advection::explicit_euler, Advection::semi_lagrangian, Advection::maccormack, Advection::bfecc}) {
      Lattice<double> f(axis < 0 ? g.cells : g.faces(axis), 2.5), out = f;
      carry({g, u, 0.3, scheme, BackTrace::rk2, true}, axis, f, out);
      CHECK(out.values == f.values);
    }
}
