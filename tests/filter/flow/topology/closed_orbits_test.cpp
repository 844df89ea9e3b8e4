// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/closed_orbits.h"

#include <numbers>

#include "base/parallel.h"
#include "filter/flow/topology/topology_support.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::topology;

namespace {

using std::numbers::pi;

// Balthasar van der Pol's oscillator of strength 1: a cycle of amplitude 2.00862 and period 6.66329 about a source.
Vec3 van_der_pol(Vec3 x) { return {x.y, (1 - x.x * x.x) * x.y - x.x, 0}; }
// Hopf's normal form: r' = r (1 - r^2), angle' = 1. The multiplier of the circle is exp(-4 pi).
Vec3 hopf(Vec3 x) {
  const double g = 1 - x.x * x.x - x.y * x.y;
  return {x.x * g - x.y, x.y * g + x.x, 0};
}
// Three cycles, at r = 1 and 3 repelling or attracting in turn: r' = k r (r - 1)(r - 2)(r - 3).
Vec3 three(Vec3 x) {
  const double r = std::hypot(x.x, x.y), g = 0.1 * (r - 1) * (r - 2) * (r - 3);
  return {x.x * g - x.y, x.y * g + x.x, 0};
}

double amplitude(const Orbit& o) {
  double most = 0;
  for (const Vec3 p : o.points) most = std::max(most, p.x);
  return most;
}

std::vector<Orbit> orbits_of(const DatasetPtr& d) {
  Context context;
  const FlowParts flow(d, "", "test", context);
  const CriticalPoints critical = find_critical_points(flow, {}, context);
  return find_closed_orbits(flow, critical, find_separatrices(flow, critical, {}, {}, context), {}, context);
}

}  // namespace

TEST_CASE("orbits: of analytic flows, period and multiplier to many digits") {
  AnalyticFlow cycle{[](Vec3 x, double) { return van_der_pol(x); }, 0.1};
  ReturnOptions o;
  o.cell = 0.1;
  const auto vdp = periodic_orbit(cycle, Vec3(0.2, 1.9, 0), {0, 0, 1}, 1, o);
  REQUIRE(vdp);
  CHECK(vdp->period == doctest::Approx(6.6632868593).epsilon(1e-7));
  CHECK(amplitude(*vdp) == doctest::Approx(2.00861986).epsilon(1e-3));
  CHECK(vdp->multiplier < 0.01);

  AnalyticFlow circle{[](Vec3 x, double) { return hopf(x); }, 0.1};
  const auto one = periodic_orbit(circle, Vec3(0.9, 0.3, 0), {0, 0, 1}, 1, o);
  REQUIRE(one);
  CHECK(one->period == doctest::Approx(2 * pi).epsilon(1e-7));
  for (const Vec3 p : one->points) CHECK(length(p) == doctest::Approx(1).epsilon(1e-6));

  AnalyticFlow rotation{[](Vec3 x, double) { return Vec3(-x.y, x.x, 0); }, 0.1};
  CHECK_FALSE(periodic_orbit(rotation, Vec3(0.9, 0.3, 0), {0, 0, 1}, 1, o));  // one of a family
  AnalyticFlow straight{[](Vec3, double) { return Vec3(1, 0, 0); }, 0.1};
  CHECK_FALSE(periodic_orbit(straight, Vec3(0.9, 0.3, 0), {0, 0, 1}, 1, o));
  AnalyticFlow apart{[](Vec3 x, double) { return -1.0 * hopf(x); }, 0.1};
  const auto repelling = periodic_orbit(apart, Vec3(0.9, 0.3, 0), {0, 0, 1}, -1, o);
  REQUIRE(repelling);
  CHECK(repelling->multiplier > 1000);
}

TEST_CASE("orbits: the van der Pol cycle on a grid") {
  const auto found = orbits_of(plane_grid(161, 161, -3, 3, -4, 4, van_der_pol));
  REQUIRE(found.size() == 1);
  CHECK(found[0].period == doctest::Approx(6.66329).epsilon(2e-3));
  CHECK(amplitude(found[0]) == doctest::Approx(2.00862).epsilon(2e-3));
  CHECK(found[0].multiplier < 0.01);
}

TEST_CASE("orbits: the Hopf circle on triangles, attracting or repelling") {
  for (const double sign : {1.0, -1.0}) {
    const DatasetPtr d =
        with_velocity(plane_cells(CellType::triangle, 3, 40, [](Vec3 p) { return 1.6 * p; }), [&](Vec3 x) { return sign * hopf(x); });
    const auto found = orbits_of(d);
    REQUIRE(found.size() == 1);
    CHECK(found[0].period == doctest::Approx(2 * pi).epsilon(5e-3));
    for (const Vec3 p : found[0].points) CHECK(length(p) == doctest::Approx(1).epsilon(5e-3));
    CHECK((found[0].multiplier > 1) == (sign < 0));
  }
}

TEST_CASE("orbits: one inside the other") {
  const auto found = orbits_of(plane_grid(121, 121, -3.5, 3.5, -3.5, 3.5, three));
  REQUIRE(found.size() == 3);
  std::vector<std::pair<double, bool>> r;
  for (const Orbit& o : found) r.emplace_back(amplitude(o), o.multiplier > 1);
  std::sort(r.begin(), r.end());
  for (size_t k = 0; k < 3; ++k) {
    CHECK(r[k].first == doctest::Approx(double(k + 1)).epsilon(0.01));
    CHECK(r[k].second == (k != 1));
  }
}

TEST_CASE("orbits: families about centres and flows without cycles have none; the same for any number of threads") {
  CHECK(orbits_of(plane_grid(33, 33, -1, 1, -1, 1, [](Vec3 x) { return Vec3(-x.y, x.x, 0); })).empty());
  CHECK(orbits_of(plane_grid(65, 33, 0, 2, 0, 1, [](Vec3 x) { return double_gyre(x, 0.1); })).empty());
  CHECK(orbits_of(plane_grid(9, 9, -1, 1, -1, 1, [](Vec3) { return Vec3(1, 0.3, 0); })).empty());
  Context context;
  const DatasetPtr d = plane_grid(61, 61, -3.5, 3.5, -3.5, 3.5, three);
  set_thread_count(1);
  const DatasetPtr one = closed_orbits(d, {}, context);
  set_thread_count(8);
  const DatasetPtr eight = closed_orbits(d, {}, context);
  set_thread_count(0);
  CHECK(sg::test::meshes::same_surface(*one, *eight));
  CHECK(one->cell_count() == 3);
  const std::string said = sg::test::error_of(
      [&] { closed_orbits(with_velocity(sg::test::meshes::uniform_box(2, 2, 2), [](Vec3 x) { return x; }), {}, context); });
  CHECK(said.find("flat meshes") != std::string::npos);
}
