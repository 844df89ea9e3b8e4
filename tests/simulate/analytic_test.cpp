// SPDX-License-Identifier: Apache-2.0
// Analytic sources against what their formulas must satisfy.
#include <algorithm>
#include <cmath>

#include "data/lattice.h"
#include "simulate/flow_fields.h"
#include "simulate/point_load.h"
#include "simulate/scalar_fields.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

struct Sampled {
  DatasetPtr d;
  Lattice lattice;
  const Field& f;
  std::array<size_t, 3> n;
  Sampled(DatasetPtr data, const char* field)
      : d(std::move(data)), lattice(d->mesh()), f(d->fields().require(field, Association::point)), n(lattice.view().dims) {}
  double at(size_t i, size_t j, size_t k, int c = 0) const { return f.array.get(lattice.view().id(i, j, k), c); }
  Vec3 place(size_t i, size_t j, size_t k) const { return lattice.view().position(i, j, k); }
  // Central difference along an axis; 0 along an axis of one point.
  double slope(size_t i, size_t j, size_t k, int c, int axis) const {
    if (n[size_t(axis)] == 1) return 0;
    const double h = d->as<UniformGrid>()->spacing[axis];
    const size_t x = axis == 0, y = axis == 1, z = axis == 2;
    return (at(i + x, j + y, k + z, c) - at(i - x, j - y, k - z, c)) / (2 * h);
  }
};

GridParams grid(int n, std::vector<double> bounds = {}) { return {n, {}, std::move(bounds), FieldType::f64}; }

}  // namespace

TEST_CASE("sources: size, dims, bounds and type make the grid") {
  Context c;
  DoubleGyreParams g;
  g.grid = {.size = 21, .dims = {}, .bounds = {}, .type = FieldType::f64};
  auto d = double_gyre(g, c);
  CHECK(d->as<UniformGrid>()->dims == std::array<size_t, 3>{21, 11, 1});
  CHECK(d->fields().require("velocity").array.type() == ElementType::f64);
  CHECK(d->bounds().hi == Vec3(2, 1, 0));
  SphereParams s;
  s.grid.dims = {4, 5, 6};
  s.grid.bounds = {0, 3, 0, 4, 0, 10};
  d = sphere(s, c);
  CHECK(d->as<UniformGrid>()->dims == std::array<size_t, 3>{4, 5, 6});
  CHECK(d->as<UniformGrid>()->spacing == Vec3(1, 1, 2));
  CHECK(d->fields().require("distance").array.type() == ElementType::f32);
  s.grid.dims = {4, 5};
  CHECK(error_of([&] { sphere(s, c); }).find("three numbers") != std::string::npos);
  s.grid.dims = {};
  s.grid.bounds = {0, 1, 0, 1};
  CHECK(error_of([&] { sphere(s, c); }).find("x0,x1") != std::string::npos);
  s.grid.bounds = {1, 0, 0, 1, 0, 1};
  CHECK(error_of([&] { sphere(s, c); }).find("lower one first") != std::string::npos);
  s.grid.bounds = {};
  s.grid.dims = {65536, 65536, 65536};
  CHECK(error_of([&] { sphere(s, c); }).find("more points") != std::string::npos);
  s.grid.dims = {0, 1, 1};
  CHECK(error_of([&] { sphere(s, c); }).find("at least 1") != std::string::npos);
  s.grid.dims = {100, 100, 100};
  c.memory_limit = 1000;
  CHECK(error_of([&] { sphere(s, c); }).find("memory limit") != std::string::npos);
}

TEST_CASE("sources: parameters are described, read from words and checked") {
  HydrogenParams p;
  Schema s = schema_of(p);
  set_params(s, {"n=4", "l=3", "m=-2", "size=9", "bounds=-1,1,-1,1,-1,1"}, "hydrogen");
  CHECK((p.n == 4 && p.l == 3 && p.m == -2 && p.grid.size == 9 && p.grid.bounds.size() == 6));
  CHECK(error_of([&] { set_params(s, {"type=u8"}, "hydrogen"); }).find("f32") != std::string::npos);
  Context c;
  p.l = 4;
  CHECK(error_of([&] { hydrogen(p, c); }).find("no orbital n=4 l=4") != std::string::npos);
  MarschnerLobbParams a;
  TangleParams b;
  GyroidParams e;
  SphereParams f;
  TorusParams g;
  AbcParams h;
  DoubleGyreParams i;
  TaylorGreenParams j;
  PointLoadParams k;
  for (const Schema& schema :
       {schema_of(a), schema_of(b), schema_of(e), schema_of(f), schema_of(g), schema_of(h), schema_of(i), schema_of(j), schema_of(k)}) {
    CHECK(schema.find("size"));
    for (const ParamDecl& decl : schema.decls()) CHECK(decl.doc.back() == '.');
  }
}

TEST_CASE("marschner_lobb: round about z, in [0,1], known values") {
  Context c;
  MarschnerLobbParams p;
  p.grid = grid(41);
  const Sampled s(marschner_lobb(p, c), "density");
  const Range r = s.d->range(s.f);
  CHECK((r.lo >= 0 && r.hi <= 1));
  // rho(0) = cos(2 pi 6) = 1, so the middle has (1 - 0 + .25*2)/2.5, the ends of the axis with sin = +-1.
  CHECK(s.at(20, 20, 20) == doctest::Approx(1.5 / 2.5));
  CHECK(s.at(20, 20, 40) == doctest::Approx(0.5 / 2.5));
  CHECK(s.at(20, 20, 0) == doctest::Approx(2.5 / 2.5));
  CHECK(s.at(20 + 12, 20 + 16, 7) == doctest::Approx(s.at(20 + 20, 20, 7)));
  CHECK(MarschnerLobbParams().grid.size == 40);
}

TEST_CASE("tangle: full symmetry of the cube and values by hand") {
  Context c;
  TangleParams p;
  p.grid = grid(13);
  const Sampled s(tangle(p, c), "tangle");
  CHECK(s.at(6, 6, 6) == doctest::Approx(11.8));
  CHECK(s.at(8, 6, 6) == doctest::Approx(11.8 - 4));
  CHECK(s.at(0, 2, 5) == doctest::Approx(s.at(5, 10, 12)));
}

TEST_CASE("gyroid: eigenfunction of the Laplacian, period") {
  Context c;
  GyroidParams p;
  p.period = 2;
  double error[2];
  for (int q = 0; q < 2; ++q) {
    p.grid = grid(q ? 65 : 33, {0, 2, 0, 2, 0, 2});
    const Sampled s(gyroid(p, c), "gyroid");
    const double h = s.d->as<UniformGrid>()->spacing.x, k = M_PI;
    error[q] = 0;
    for (size_t i = 1; i + 1 < s.n[0]; i += 3)
      for (size_t j = 1; j + 1 < s.n[0]; j += 2) {
        const size_t m = s.n[0] / 3;
        const double lap = (s.at(i + 1, j, m) + s.at(i - 1, j, m) + s.at(i, j + 1, m) + s.at(i, j - 1, m) + s.at(i, j, m + 1) +
                            s.at(i, j, m - 1) - 6 * s.at(i, j, m)) /
                           (h * h);
        error[q] = std::max(error[q], std::abs(lap + 2 * k * k * s.at(i, j, m)));
      }
    CHECK(s.at(0, 3, 5) == doctest::Approx(s.at(s.n[0] - 1, 3, 5)).epsilon(1e-9));
  }
  CHECK(std::log2(error[0] / error[1]) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("sphere and torus: distances have unit gradients and the right zero") {
  Context c;
  SphereParams sp;
  sp.grid = grid(41);
  sp.center = {1, 2, 3};
  sp.radius = 2;
  const Sampled s(sphere(sp, c), "distance");
  CHECK(s.at(20, 20, 20) == doctest::Approx(-2));
  TorusParams tp;
  tp.grid = grid(61);
  const Sampled t(torus(tp, c), "distance");
  int checked = 0;
  for (const Sampled* d : {&s, &t})
    for (size_t i = 5; i < d->n[0] - 5; i += 2) {
      const size_t j = d->n[1] / 2 + 5, k = d->n[2] / 2 + 1;
      if (std::abs(d->at(i, j, k)) > 0.25) continue;  // away from the kinks in the middle
      ++checked;
      const Vec3 g(d->slope(i, j, k, 0, 0), d->slope(i, j, k, 0, 1), d->slope(i, j, k, 0, 2));
      CHECK(length(g) == doctest::Approx(1).epsilon(0.03));
    }
  CHECK(checked > 4);
  for (int a = 0; a < 8; ++a) {
    tp.grid.dims = {1, 1, 1};
    const double u = a * 0.7, v = a * 1.3;
    const Vec3 p((1 + 0.4 * std::cos(v)) * std::cos(u), (1 + 0.4 * std::cos(v)) * std::sin(u), 0.4 * std::sin(v));
    tp.grid.bounds = {p.x, p.x, p.y, p.y, p.z, p.z};
    const auto one = torus(tp, c);
    CHECK(one->point_count() == 1);
    CHECK(one->fields().require("distance").array.get(0) == doctest::Approx(0));
  }
}

TEST_CASE("hydrogen: the density integrates to 1 and orbitals are orthogonal and known") {
  Context c;
  for (auto [n, l, m] : {std::array{1, 0, 0}, {2, 1, 0}, {2, 1, -1}, {3, 2, 2}, {3, 1, 1}, {4, 3, -2}, {4, 0, 0}}) {
    HydrogenParams p;
    p.n = n, p.l = l, p.m = m;
    p.grid = grid(61);
    p.grid.bounds = {};
    const Sampled s(hydrogen(p, c), "probability density");
    const Vec3 h = s.d->as<UniformGrid>()->spacing;
    double sum = 0;
    for (size_t i = 0; i < s.f.array.count(); ++i) sum += s.f.array.get(i);
    CAPTURE(n);
    CAPTURE(l);
    CAPTURE(m);
    CHECK(sum * h.x * h.y * h.z == doctest::Approx(1).epsilon(n == 1 ? 0.02 : 0.005));
  }
  // psi_100 = exp(-r)/sqrt(pi); psi_200 = (2-r) exp(-r/2) / (4 sqrt(2 pi)); psi_210 = z exp(-r/2) / (4 sqrt(2 pi)); psi_320 by hand.
  const Vec3 p(0.3, -0.4, 1.2);
  const double r = 1.3;
  CHECK(hydrogen_orbital(1, 0, 0, p) == doctest::Approx(std::exp(-r) / std::sqrt(M_PI)));
  CHECK(hydrogen_orbital(2, 0, 0, p) == doctest::Approx((2 - r) * std::exp(-r / 2) / (4 * std::sqrt(2 * M_PI))));
  CHECK(hydrogen_orbital(2, 1, 0, p) == doctest::Approx(p.z * std::exp(-r / 2) / (4 * std::sqrt(2 * M_PI))));
  CHECK(hydrogen_orbital(2, 1, 1, p) == doctest::Approx(p.x * std::exp(-r / 2) / (4 * std::sqrt(2 * M_PI))));
  CHECK(hydrogen_orbital(2, 1, -1, p) == doctest::Approx(p.y * std::exp(-r / 2) / (4 * std::sqrt(2 * M_PI))));
  CHECK(hydrogen_orbital(3, 2, 0, p) == doctest::Approx((3 * p.z * p.z - r * r) * std::exp(-r / 3) / (81 * std::sqrt(6 * M_PI))));
  // Schroedinger's equation by differences: -lap psi / 2 - psi / r = -psi / (2 n^2).
  for (auto [n, l, m] : {std::array{3, 2, 1}, {4, 2, -2}, {5, 3, 3}}) {
    const double h = 1e-3;
    const Vec3 q(1.1, 0.7, -0.9);
    const double here = hydrogen_orbital(n, l, m, q);
    double lap = -6 * here;
    for (int a = 0; a < 3; ++a)
      for (double sign : {-1.0, 1.0}) {
        Vec3 x = q;
        x[a] += sign * h;
        lap += hydrogen_orbital(n, l, m, x);
      }
    CHECK(-lap / (h * h) / 2 - here / length(q) == doctest::Approx(-here / (2.0 * n * n)).epsilon(1e-3));
  }
  CHECK(std::isfinite(hydrogen_orbital(3, 1, 0, {0, 0, 0})));
}

TEST_CASE("abc: divergence 0, curl u = u, mean square a^2+b^2+c^2") {
  Context c;
  AbcParams p;
  double div = 0, curl[2];
  for (int q = 0; q < 2; ++q) {
    p.grid = grid(q ? 49 : 25);
    const Sampled s(abc(p, c), "velocity");
    CHECK(s.f.role == Role::vectors);
    const size_t n = s.n[0];
    double mean = 0;
    curl[q] = 0;
    for (size_t k = 0; k + 1 < n; ++k)
      for (size_t j = 0; j + 1 < n; ++j)
        for (size_t i = 0; i + 1 < n; ++i) {
          for (int a = 0; a < 3; ++a) mean += s.at(i, j, k, a) * s.at(i, j, k, a);
          if (!i || !j || !k) continue;
          div = std::max(div, std::abs(s.slope(i, j, k, 0, 0) + s.slope(i, j, k, 1, 1) + s.slope(i, j, k, 2, 2)));
          curl[q] = std::max(curl[q], std::abs(s.slope(i, j, k, 2, 1) - s.slope(i, j, k, 1, 2) - s.at(i, j, k, 0)));
          curl[q] = std::max(curl[q], std::abs(s.slope(i, j, k, 0, 2) - s.slope(i, j, k, 2, 0) - s.at(i, j, k, 1)));
          curl[q] = std::max(curl[q], std::abs(s.slope(i, j, k, 1, 0) - s.slope(i, j, k, 0, 1) - s.at(i, j, k, 2)));
        }
    CHECK(mean / std::pow(double(n - 1), 3) == doctest::Approx(6).epsilon(1e-9));
  }
  CHECK(div < 1e-12);
  CHECK(std::log2(curl[0] / curl[1]) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("double_gyre: the stream function's derivatives, closed walls") {
  Context c;
  DoubleGyreParams p;
  p.time = 3.7;
  p.grid = grid(201);
  const auto d = double_gyre(p, c);
  const Sampled u(d, "velocity"), psi(d, "stream function");
  CHECK(d->time() == 3.7);
  double e = 0;
  for (size_t j = 1; j + 1 < u.n[1]; j += 5)
    for (size_t i = 1; i + 1 < u.n[0]; i += 5)
      e = std::max({e, std::abs(u.at(i, j, 0, 0) + psi.slope(i, j, 0, 0, 1)), std::abs(u.at(i, j, 0, 1) - psi.slope(i, j, 0, 0, 0))});
  CHECK(e < 1e-3);
  for (size_t i = 0; i < u.n[0]; ++i) CHECK(std::abs(u.at(i, 0, 0, 1)) + std::abs(u.at(i, u.n[1] - 1, 0, 1)) < 1e-12);
  for (size_t j = 0; j < u.n[1]; ++j) CHECK(std::abs(u.at(0, j, 0, 0)) + std::abs(u.at(u.n[0] - 1, j, 0, 0)) < 1e-12);
}

TEST_CASE("taylor_green: divergence 0 and the steady momentum balance with its pressure") {
  Context c;
  TaylorGreenParams p;
  p.grid = grid(129);
  p.viscosity = 0.05;
  p.time = 2;
  const auto d = taylor_green(p, c);
  const Sampled u(d, "velocity"), q(d, "pressure");
  double div = 0, momentum = 0, energy = 0;
  for (size_t j = 1; j + 1 < u.n[1]; ++j)
    for (size_t i = 1; i + 1 < u.n[0]; ++i) {
      div = std::max(div, std::abs(u.slope(i, j, 0, 0, 0) + u.slope(i, j, 0, 1, 1)));
      // (u grad) u = -grad p; du/dt = -2 nu u is balanced by the viscous term. The other sign of p would fail here.
      for (int a = 0; a < 2; ++a)
        momentum = std::max(momentum, std::abs(u.at(i, j, 0, 0) * u.slope(i, j, 0, a, 0) + u.at(i, j, 0, 1) * u.slope(i, j, 0, a, 1) +
                                               q.slope(i, j, 0, 0, a)));
    }
  CHECK(div < 1e-12);
  CHECK(momentum < 2e-3);
  for (size_t j = 0; j + 1 < u.n[1]; ++j)
    for (size_t i = 0; i + 1 < u.n[0]; ++i)
      energy += 0.5 * (u.at(i, j, 0, 0) * u.at(i, j, 0, 0) + u.at(i, j, 0, 1) * u.at(i, j, 0, 1)) / 128 / 128;
  CHECK(energy == doctest::Approx(0.25 * std::exp(-4 * 0.05 * 2)).epsilon(1e-9));
}

TEST_CASE("point_load: on-axis values, balance of forces, free surface, whole load carried") {
  double s[9];
  const double P = 3, nu = 0.3, z = 1.7;
  point_load_stress(P, nu, {0, 0, z}, s);
  CHECK(s[8] == doctest::Approx(-3 * P / (2 * M_PI * z * z)));
  CHECK(s[0] == doctest::Approx((1 - 2 * nu) * P / (4 * M_PI * z * z)));
  CHECK(s[4] == doctest::Approx(s[0]));
  for (int i : {1, 2, 3, 5, 6, 7}) CHECK(s[i] == doctest::Approx(0));
  // div s = 0 by central differences at some places; trace -(1+nu) P z / (pi R^3).
  for (const Vec3 p : {Vec3(0.5, 0.3, 0.8), Vec3(-0.2, 0.9, 0.4), Vec3(0.01, 0, 1)}) {
    const double h = 1e-4;
    double div[3] = {}, lo[9], hi[9];
    for (int a = 0; a < 3; ++a) {
      Vec3 q = p;
      q[a] += h;
      point_load_stress(P, nu, q, hi);
      q[a] -= 2 * h;
      point_load_stress(P, nu, q, lo);
      for (int i = 0; i < 3; ++i) div[i] += (hi[3 * i + a] - lo[3 * i + a]) / (2 * h);
    }
    for (double d : div) CHECK(std::abs(d) < 1e-5);
    point_load_stress(P, nu, p, s);
    CHECK(s[0] + s[4] + s[8] == doctest::Approx(-(1 + nu) * P * p.z / (M_PI * std::pow(length(p), 3))));
    CHECK((s[1] == s[3] && s[2] == s[6] && s[5] == s[7]));
  }
  // The surface is free of load away from the origin.
  point_load_stress(P, nu, {0.4, -0.7, 0}, s);
  CHECK(std::abs(s[2]) + std::abs(s[5]) + std::abs(s[8]) < 1e-12);
  // The plane z carries -P.
  double sum = 0;
  const double w = 0.05;
  for (double y = -40; y < 40; y += w)
    for (double x = -40; x < 40; x += w) {
      point_load_stress(P, nu, {x + w / 2, y + w / 2, 0.5}, s);
      sum += s[8] * w * w;
    }
  CHECK(sum == doctest::Approx(-P).epsilon(1e-4));
  Context c;
  PointLoadParams p;
  p.grid = grid(5, {-1, 1, -1, 1, -1, 1});
  const auto d = point_load(p, c);
  const Field& f = d->fields().require("stress");
  CHECK((f.components() == 9 && f.role == Role::tensors));
  CHECK(std::isnan(f.array.get(0)));
  CHECK(std::isnan(f.array.get(2 + 5 * (2 + 5 * 2))));
  CHECK(std::isfinite(f.array.get(124)));
  CHECK(d->fields().require("von Mises stress").array.get(124) > 0);
  p.grid.bounds = {};
  const auto whole = point_load(p, c);
  for (size_t i = 0; i < whole->point_count(); ++i) CHECK(std::isfinite(whole->fields().require("stress").array.get(i)));
}
