// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/water/flip.h"

#include <cmath>
#include <random>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "support/test.h"

using namespace sg;
using namespace sg::fluid;

namespace {

Vec3 affine(Vec3 x) { return {1 + 0.3 * x.x - 0.2 * x.y + 0.1 * x.z, -0.5 + 0.4 * x.x + 0.25 * x.z, 0.2 * x.y - 0.3 * x.z}; }

FlipLiquidParams flat_basin() {
  FlipLiquidParams p;
  p.size = 40, p.bounds = {0, 2, 0, 1, 0, 0}, p.frame = 0.05;
  return p;
}

double front(const FlipLiquid& run) {
  double most = 0;
  for (const Particle3& q : run.particles()) most = std::max(most, q.x.x);
  return run.grid().origin.x + run.grid().h * most;
}

}  // namespace

TEST_CASE("flip: apic carries an affine velocity to the grid and back without a change") {
  Context context;
  const MacGrid g{{9, 8, 7}, 1, {}};
  std::mt19937_64 random(3);
  const auto real = [&] { return double(random() >> 11) * 0x1p-53; };
  std::vector<Particle3> particles;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 x(0.6 + 7.8 * real(), 0.6 + 6.8 * real(), 0.6 + 5.8 * real());
    particles.push_back({x, affine(x), {Vec3(0.3, -0.2, 0.1), Vec3(0.4, 0, 0.25), Vec3(0, 0.2, -0.3)}});
  }
  const auto begin = sort_by_cell(g, particles);
  CHECK(begin.back() == particles.size());
  Faces<double> u = make_faces<double>(g), weight = u;
  particles_to_faces(g, particles, begin, u, weight, context);
  for (int a = 0; a < 3; ++a) {
    const auto s = MacGrid::shift(a);
    const Lattice<double>& l = u[size_t(a)];
    for (size_t k = 0; k < l.n[2]; ++k)
      for (size_t j = 0; j < l.n[1]; ++j)
        for (size_t i = 0; i < l.n[0]; ++i)
          if (weight[size_t(a)](i, j, k) > 0)
            CHECK(l(i, j, k) == doctest::Approx(affine({double(i) + s[0], double(j) + s[1], double(k) + s[2]})[a]).scale(1).epsilon(1e-12));
  }
  std::array<Vec3, 3> c;
  const Vec3 x(4.3, 3.9, 3.2), v = velocity_at(g, u, x, &c);
  CHECK(length(v - affine(x)) < 1e-12);
  CHECK(length(c[0] - Vec3(0.3, -0.2, 0.1)) < 1e-12);
  CHECK(length(c[1] - Vec3(0.4, 0, 0.25)) < 1e-12);
}

TEST_CASE("flip: water that touches nothing falls freely") {
  Context context;
  for (const Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic}) {
    FlipLiquidParams p = flat_basin();
    p.water = {0.8, 1.2, 0.5, 0.8, 0, 0}, p.transfer = transfer, p.tolerance = 1e-10, p.frame = 0.1;
    FlipLiquid run(p, context);
    run.advance(context);
    for (const Particle3& q : run.particles()) {
      CHECK(q.v.y == doctest::Approx(-0.981).epsilon(1e-6));
      CHECK(q.v.x == doctest::Approx(0).scale(1).epsilon(1e-6));
    }
  }
}

TEST_CASE("flip: water at rest stays at rest") {
  Context context;
  FlipLiquidParams p = flat_basin();
  p.water = {0, 2, 0, 0.5, 0, 0}, p.tolerance = 1e-9;
  FlipLiquid run(p, context);
  const double before = run.energy();
  for (int f = 0; f < 10; ++f) run.advance(context);
  for (const Particle3& q : run.particles()) CHECK(length(q.v) < 1e-6);
  CHECK(run.energy() == doctest::Approx(before).epsilon(1e-9));
  const DatasetPtr d = run.dataset(context);
  const Array& water = d->fields().require("water").array;
  CHECK(water.view<float>()[5 * 40 + 20] == doctest::Approx(1));
  CHECK(water.view<float>()[15 * 40 + 20] == 0);
}

TEST_CASE("flip: the front of a breaking dam is where Martin and Moyce (1952) saw it") {
  // Their column of a square section doubled, height 2a: Z = x / a against T = t sqrt(2 g / a), for a = 2.25 in.
  Context context;
  const double seen[][2] = {{0.84, 1.22}, {1.19, 1.44}, {1.43, 1.67}, {1.63, 1.89}, {1.83, 2.11}, {1.98, 2.33},
                            {2.20, 2.56}, {2.32, 2.78}, {2.51, 3.00}, {2.65, 3.22}, {2.83, 3.44}};
  FlipLiquidParams p;
  p.size = 100, p.bounds = {0, 5, 0, 2.5, 0, 0}, p.water = {0, 1, 0, 2, 0, 0}, p.gravity = Vec3(0, -1, 0), p.frame = 0.05 / std::sqrt(2.0);
  FlipLiquid run(p, context);
  const double energy = run.energy();
  const size_t count = run.particles().size();
  double before = 1;
  size_t next = 0;
  for (int f = 1; next < std::size(seen); ++f) {
    run.advance(context);
    const double now = front(run), time = 0.05 * f;
    if (time >= seen[next][0]) {
      const double z = before + (now - before) * (seen[next][0] - (time - 0.05)) / 0.05;
      INFO("T " << seen[next][0]);
      CHECK(z == doctest::Approx(seen[next][1]).epsilon(0.1));
      ++next;
    }
    before = now;
  }
  CHECK(run.energy() < energy);
  CHECK(run.particles().size() == count);
}

TEST_CASE("flip: the mirror image of a splash is itself") {
  Context context;
  FlipLiquidParams p = flat_basin();
  p.water = {0.75, 1.25, 0, 0.6, 0, 0}, p.tolerance = 1e-12;
  FlipLiquid run(p, context);
  for (int f = 0; f < 4; ++f) run.advance(context);
  Vec3 momentum;
  double middle = 0;
  for (const Particle3& q : run.particles()) momentum += q.v, middle += q.x.x;
  CHECK(middle / double(run.particles().size()) == doctest::Approx(20).epsilon(1e-6));
  CHECK(std::abs(momentum.x) / double(run.particles().size()) < 1e-6);
}

TEST_CASE("flip: particles stay in the basin and out of obstacles, in three dimensions, with the same bytes for any number of threads") {
  Context context;
  const auto run = [&](int threads) {
    set_thread_count(threads);
    FlipLiquidParams p;
    p.size = 20, p.bounds = {0, 2, 0, 1, 0, 1}, p.obstacle = {1, 0.5, 0, 0.3}, p.frame = 0.1, p.cfl = 3;
    FlipLiquid liquid(p, context);
    for (int f = 0; f < 6; ++f) liquid.advance(context);
    return liquid.particles();
  };
  const auto one = run(1), three = run(3);
  set_thread_count(0);
  REQUIRE(one.size() == three.size());
  for (size_t i = 0; i < one.size(); ++i) {
    CHECK(one[i].x == three[i].x);
    CHECK(one[i].v == three[i].v);
    const Vec3 x = 0.1 * one[i].x;
    CHECK(x.x > 0);
    CHECK(x.x < 2);
    CHECK(x.z > 0);
    CHECK(length(x - Vec3(1, 0.5, 0)) > 0.3 - 0.02);
  }
}

TEST_CASE("flip: what cannot be computed is said") {
  Context context;
  const auto fails = [&](auto change, const char* word) {
    FlipLiquidParams p = flat_basin();
    change(p);
    CHECK_THROWS_WITH_AS(flip_liquid(p, context), doctest::Contains(word), Error);
  };
  fails([](FlipLiquidParams& p) { p.water = {0, 0.01, 0, 0.01, 0, 0}; }, "no water");
  fails([](FlipLiquidParams& p) { p.water = {5, 6, 0, 1, 0, 0}; }, "outside");
  fails([](FlipLiquidParams& p) { p.gravity = Vec3(0, -1e12, 0), p.time = 1; }, "frame 1");
  fails([](FlipLiquidParams& p) { p.obstacle = {1, 0.5, 0, 9}; }, "no");
}
