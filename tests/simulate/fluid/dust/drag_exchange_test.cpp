// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/dust/drag_exchange.h"

#include <cmath>
#include <random>

#include "base/parallel.h"
#include "support/test.h"

using namespace sg;
using namespace sg::fluid;

namespace {

std::mt19937_64 dice(7);
double chance() { return double(dice() >> 11) * 0x1p-53; }

double volume_of(const MacGrid& g) { return std::pow(g.h, g.axes()); }

Vec3 momentum_of(const MacGrid& g, const Faces<double>& u, const std::vector<DustParticle>& dust, double mass) {
  Vec3 sum;
  for (int a = 0; a < g.axes(); ++a)
    for (const double v : u[size_t(a)].values) sum[a] += volume_of(g) * v;
  for (const DustParticle& q : dust) sum += mass * q.v;
  return sum;
}

double energy_of(const MacGrid& g, const Faces<double>& u, const std::vector<DustParticle>& dust, double mass) {
  double sum = 0;
  for (int a = 0; a < g.axes(); ++a)
    for (const double v : u[size_t(a)].values) sum += volume_of(g) * v * v / 2;
  for (const DustParticle& q : dust) sum += mass * dot(q.v, q.v) / 2;
  return sum;
}

Walls<double> all_open() { return {{true, true, true, true, true, true}, {}, {}, {}}; }

}  // namespace

TEST_CASE("drag exchange: whatever drag, mass and step, momentum goes over and none is lost, and energy only decreases") {
  Context context;
  for (const MacGrid& g : {MacGrid{{9, 8, 10}, 0.25, {}}, MacGrid{{12, 11, 1}, 0.5, {1, 2, 3}}})
    for (const double mass : {1e-6, 1e-2, 10.0})
      for (const double drag : {1e-3, 1.0, 1e6}) {
        CAPTURE(mass);
        CAPTURE(drag);
        Faces<double> u = make_faces<double>(g);
        for (int a = 0; a < g.axes(); ++a)
          for (double& v : u[size_t(a)].values) v = chance() - 0.5;
        std::vector<DustParticle> dust(300);
        for (DustParticle& q : dust)
          for (int a = 0; a < g.axes(); ++a) q.x[a] = chance() * double(g.cells[size_t(a)]), q.v[a] = 3 * chance();
        const std::vector<uint32_t> begin = sort_by_cell(g, dust);
        const Vec3 before = momentum_of(g, u, dust, mass);
        const double energy = energy_of(g, u, dust, mass);
        DragExchange<double> exchange(g, {mass, drag, {}});
        exchange.exchange(0.1, dust, begin, u, all_open(), context);
        CHECK(length(momentum_of(g, u, dust, mass) - before) < 1e-13 * (length(before) + 1));
        CHECK(energy_of(g, u, dust, mass) < energy);
        // Behind the pressure: what the dust takes then is owed by the air.
        Faces<double> owed = make_faces<double>(g);
        for (int a = 0; a < g.axes(); ++a)
          for (double& v : u[size_t(a)].values) v *= 0.5;
        const Vec3 then = momentum_of(g, u, dust, mass);
        exchange.follow(dust, begin, u, owed, context);
        for (int a = 0; a < g.axes(); ++a)
          for (size_t i = 0; i < u[size_t(a)].values.size(); ++i) u[size_t(a)].values[i] -= owed[size_t(a)].values[i];
        CHECK(length(momentum_of(g, u, dust, mass) - then) < 1e-13 * (length(before) + 1));
      }
}

TEST_CASE("drag exchange: evenly loaded air and dust draw level by exp(-k (1/m + 1/M) t), with order 1") {
  // A particle in the middle of each face across x: then every one has the air of its face for itself, M = h^3.
  Context context;
  const MacGrid g{{6, 5, 4}, 0.5, {}};
  const double mass = 0.3, drag = 0.7, air = 0.125, time = 0.4, rate = drag * (1 / mass + 1 / air);
  const auto faces = g.faces(0);
  double error[3], h[3];
  for (int fine = 0; fine < 3; ++fine) {
    const int steps = 20 << fine;
    const double dt = time / steps;
    Faces<double> u = make_faces<double>(g);
    for (double& v : u[0].values) v = 2;
    std::vector<DustParticle> dust;
    for (size_t k = 0; k < faces[2]; ++k)
      for (size_t j = 0; j < faces[1]; ++j)
        for (size_t i = 0; i < faces[0]; ++i) dust.push_back({{double(i), double(j) + 0.5, double(k) + 0.5}, {-1, 0, 0}, dust.size()});
    const std::vector<uint32_t> begin = sort_by_cell(g, dust);
    DragExchange<double> exchange(g, {mass, drag, {}});
    for (int s = 0; s < steps; ++s) exchange.exchange(dt, dust, begin, u, all_open(), context);
    const double level = (2 * air - mass) / (air + mass), discrete = 3 * std::pow(1 + dt * rate, -steps);
    for (const double v : u[0].values) CHECK(v == doctest::Approx(level + discrete * mass / (air + mass)).epsilon(1e-11));
    for (const DustParticle& q : dust) CHECK(q.v.x == doctest::Approx(level - discrete * air / (air + mass)).epsilon(1e-11));
    error[fine] = std::abs(discrete - 3 * std::exp(-rate * time)), h[fine] = dt;
  }
  CHECK(test::observed_order(h, error, 3) == doctest::Approx(1).epsilon(0.1));
}

TEST_CASE("drag exchange: dust in still air falls at m g / k, and stiff dust has the air's velocity") {
  Context context;
  const MacGrid g{{8, 8, 8}, 1, {}};
  std::vector<DustParticle> dust{{{4.2, 3.3, 4.9}, {}, 0}};
  const std::vector<uint32_t> begin = sort_by_cell(g, dust);
  const double mass = 1e-12, drag = 4e-12;
  Faces<double> u = make_faces<double>(g);
  DragExchange<double> exchange(g, {mass, drag, {0, 0, -9.81}});
  for (int s = 0; s < 400; ++s) exchange.exchange(0.05, dust, begin, u, Walls<double>(), context);
  CHECK(dust[0].v.z == doctest::Approx(-mass * 9.81 / drag).epsilon(1e-9));
  CHECK(dust[0].v.x == 0);
  for (double& v : u[0].values) v = 5;
  DragExchange<double> stiff(g, {mass, 1, {0, 0, -9.81}});
  stiff.exchange(0.05, dust, begin, u, all_open(), context);
  CHECK(dust[0].v.x == doctest::Approx(5).epsilon(1e-9));
  CHECK(std::abs(dust[0].v.z) < 1e-9);
}

TEST_CASE("drag exchange: the same bytes for any number of threads; walls keep their velocity") {
  Context context;
  const MacGrid g{{20, 12, 16}, 1, {}};
  std::vector<DustParticle> first;
  Faces<double> air;
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    dice.seed(3);
    Faces<double> u = make_faces<double>(g, 0.5);
    std::vector<DustParticle> dust(5000);
    for (DustParticle& q : dust)
      for (int a = 0; a < 3; ++a) q.x[a] = chance() * double(g.cells[size_t(a)]), q.v[a] = chance();
    const std::vector<uint32_t> begin = sort_by_cell(g, dust);
    DragExchange<double> exchange(g, {0.1, 3, {0, 0, -1}});
    Walls<double> walls;
    walls.through[0] = 2;  // blows in
    exchange.exchange(0.2, dust, begin, u, walls, context);
    CHECK(exchange.iterations() > 2);
    CHECK(u[0](0, 3, 3) == 0.5);  // is the pressure's business
    CHECK(u[0](1, 3, 3) != 0.5);
    if (threads == 1) first = dust, air = u;
    for (size_t a = 0; a < 3; ++a) CHECK(u[a].values == air[a].values);
    bool same = true;
    for (size_t p = 0; p < dust.size(); ++p) same = same && dust[p].v == first[p].v;
    CHECK(same);
  }
  set_thread_count(0);
}
