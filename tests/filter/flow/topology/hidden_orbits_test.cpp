// SPDX-License-Identifier: Apache-2.0
// Periodic orbits about holes and about several critical points.
#include "filter/flow/topology/closed_orbits.h"

#include <numbers>

#include "filter/flow/topology/topology.h"
#include "filter/flow/topology/topology_support.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::topology;

namespace {

using std::numbers::pi;

/// r' = r g(r), angle' = 1.
template <class G>
auto turning(G g) {
  return [g](Vec3 x) {
    const double s = g(std::hypot(x.x, x.y));
    return Vec3(x.x * s - x.y, x.y * s + x.x, 0);
  };
}

/// Rings of n cells about a hole: triangles or quads with common points, or a grid whose ends meet.
template <class F>
DatasetPtr annulus(const std::string& kind, double inner, double outer, size_t rings, size_t n, F&& f) {
  const bool grid = kind == "grid";
  const size_t around = grid ? n + 1 : n;
  std::vector<double> xyz;
  for (size_t j = 0; j <= rings; ++j)
    for (size_t i = 0; i < around; ++i) {
      const double r = inner + (outer - inner) * double(j) / double(rings), angle = 2 * pi * double(i % n) / double(n);
      xyz.insert(xyz.end(), {r * std::cos(angle), r * std::sin(angle), 0});
    }
  if (grid) {
    CurvilinearGrid g;
    g.dims = {around, rings + 1, 1};
    g.points.xyz = Array::from_vector(std::move(xyz), 3);
    return with_velocity(make_dataset(std::move(g)), f);
  }
  std::vector<int64_t> ids, offsets{0};
  const auto cell = [&](std::initializer_list<size_t> c) {
    for (const size_t p : c) ids.push_back(int64_t(p));
    offsets.push_back(int64_t(ids.size()));
  };
  for (size_t j = 0; j < rings; ++j)
    for (size_t i = 0; i < n; ++i) {
      const size_t a = j * n + i, b = j * n + (i + 1) % n, c = b + n, d = a + n;
      if (kind == "triangles") cell({a, b, c}), cell({a, c, d});
      else cell({a, b, c, d});
    }
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.cells.connectivity = Array::from_vector(std::move(ids));
  m.cells.offsets = Array::from_vector(std::move(offsets));
  m.single_type = kind == "triangles" ? CellType::triangle : CellType::quad;
  return with_velocity(make_dataset(std::move(m)), f);
}

/// Radii of the orbits, ascending, negative where they repel.
std::vector<double> radii(const DatasetPtr& d) {
  Context context;
  const FlowParts flow(d, "", "test", context);
  const CriticalPoints critical = find_critical_points(flow, {}, context);
  std::vector<double> r;
  for (const Orbit& o : find_closed_orbits(flow, critical, find_separatrices(flow, critical, {}, {}, context), {}, context)) {
    double most = 0;
    for (const Vec3 p : o.points) most = std::max(most, length(p));
    r.push_back(o.multiplier > 1 ? -most : most);
  }
  std::sort(r.begin(), r.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  return r;
}
void check_radii(const std::vector<double>& found, const std::vector<double>& expected) {
  REQUIRE(found.size() == expected.size());
  for (size_t k = 0; k < found.size(); ++k) CHECK(found[k] == doctest::Approx(expected[k]).epsilon(0.02));
}

/// A saddle between two foci in a level set h of H = y^2/2 - x^2/2 + x^4/4; orbits are H = 0.3 (repelling) and H = 1 (attracting).
double energy(Vec3 x) { return x.y * x.y / 2 - x.x * x.x / 2 + x.x * x.x * x.x * x.x / 4; }
Vec3 two_about_three(Vec3 x) {
  const double hx = x.x * x.x * x.x - x.x, hy = x.y, h = energy(x), k = 0.6 * (h - 0.3) * (h - 1) / (1 + h * h);
  return {hy - k * hx, -hx - k * hy, 0};
}

std::vector<double> energies(const DatasetPtr& d) {
  Context context;
  const FlowParts flow(d, "", "test", context);
  const CriticalPoints critical = find_critical_points(flow, {}, context);
  std::vector<double> e;
  for (const Orbit& o : find_closed_orbits(flow, critical, find_separatrices(flow, critical, {}, {}, context), {}, context)) {
    double mean = 0;
    for (const Vec3 p : o.points) mean += energy(p) / double(o.points.size());
    e.push_back(o.multiplier > 1 ? -mean : mean);
  }
  std::sort(e.begin(), e.end());
  return e;
}

}  // namespace

TEST_CASE("orbits: about a hole, attracting and repelling, with flow through the borders or along them") {
  const auto one = turning([](double r) { return 1 - r * r; });
  for (const char* kind : {"triangles", "quads", "grid"}) {
    CAPTURE(kind);
    check_radii(radii(annulus(kind, 0.4, 1.8, 16, 48, one)), {1});
    check_radii(radii(annulus(kind, 0.4, 1.8, 16, 48, [&](Vec3 x) { return -1.0 * one(x); })), {-1});
  }
  check_radii(radii(annulus("triangles", 0.5, 3.6, 40, 60, turning([](double r) { return 0.15 * (r - 1) * (r - 2) * (r - 3); }))),
              {-1, 2, -3});
  // Along both borders, which are orbits themselves in the limit: that between them is found.
  const auto between = radii(annulus("quads", 0.5, 1.5, 24, 60, turning([](double r) { return 0.8 * (r - 0.5) * (r - 1) * (r - 1.5); })));
  CHECK(std::any_of(between.begin(), between.end(), [](double r) { return std::abs(std::abs(r) - 1) < 0.03; }));
}

TEST_CASE("orbits: two about three critical points, which may lie in a hole of hidden cells") {
  const DatasetPtr d = plane_grid(91, 71, -2.4, 2.4, -1.9, 1.9, two_about_three);
  const auto e = energies(d);
  REQUIRE(e.size() == 2);
  CHECK(e[0] == doctest::Approx(-0.3).epsilon(0.05));
  CHECK(e[1] == doctest::Approx(1).epsilon(0.05));
  DatasetParts parts = d->parts();
  std::vector<uint8_t> ghost;
  for (size_t j = 0; j < 70; ++j)
    for (size_t i = 0; i < 90; ++i) {
      const Vec3 x(-2.4 + 4.8 * (double(i) + 0.5) / 90, -1.9 + 3.8 * (double(j) + 0.5) / 70, 0);
      ghost.push_back(energy(x) < 0.1 ? ghost_hidden_cell : 0);
    }
  parts.cell_ghost = Array::from_vector(std::move(ghost));
  const auto about_hole = energies(make_dataset(std::move(parts)));
  REQUIRE(about_hole.size() == 2);
  CHECK(about_hole[0] == doctest::Approx(-0.3).epsilon(0.05));
  CHECK(about_hole[1] == doctest::Approx(1).epsilon(0.05));
}

TEST_CASE("orbits: closed lines about centres are a family, and said to be one") {
  Context context;
  std::string told;
  context.on_log = [&](LogLevel, std::string_view t) { told += t; };
  const auto stream = [](Vec3 x) { return Vec3(-x.y, x.x - 0.4 * x.x * x.x * x.x, 0); };
  CHECK(closed_orbits(plane_grid(41, 41, -1.4, 1.4, -1.4, 1.4, stream), {}, context)->cell_count() == 0);
  CHECK(told.find("families around centres") != std::string::npos);
  told.clear();
  CHECK(closed_orbits(plane_grid(53, 53, 0.3, 6.8, 0.2, 6.9, taylor_green), {}, context)->cell_count() == 0);
  CHECK(told.find("0 attracting, 0 repelling") != std::string::npos);
}

TEST_CASE("orbits: isolated by errors of interpolation only they are families, isolated by the flow they are orbits") {
  // On skewed, coarse cells the divergence of samples is not that of the flow: closed lines open a little, this way or that.
  const auto skewed = [](CellType type, size_t nodes, auto&& f) {
    return with_velocity(
        plane_cells(type, nodes, 15,
                    [](Vec3 p) { return 1.7 * p + 0.05 * Vec3(std::sin(17 * p.x + 23 * p.y), std::sin(29 * p.x - 13 * p.y), 0); }),
        f);
  };
  const auto centre = [](Vec3 x) { return Vec3(-x.y + 0.3 * std::sin(2 * x.y), std::sin(1.5 * x.x), 0); };
  const auto hopf = [](double k) { return turning([k](double r) { return k * (1 - r * r); }); };
  for (const auto& [type, nodes] : {std::pair(CellType::quad, size_t(4)), std::pair(CellType::triangle, size_t(3))}) {
    CAPTURE(int(type));
    Context context;
    const CriticalPoints zeros = zeros_of(skewed(type, nodes, centre));
    REQUIRE(zeros.points.size() == 1);
    CHECK(zeros.points[0].flow.type == CriticalType::centre);
    CHECK(closed_orbits(skewed(type, nodes, centre), {}, context)->cell_count() == 0);
    CHECK(closed_orbits(skewed(type, nodes, centre), {.isolated = 1e-6}, context)->cell_count() == 0);
    for (const double k : {0.1, -0.1, 1.0}) {
      CAPTURE(k);
      const auto r = radii(skewed(type, nodes, hopf(k)));
      REQUIRE(r.size() == 1);
      CHECK(std::abs(r[0]) == doctest::Approx(1).epsilon(0.03));
      CHECK((r[0] < 0) == (k < 0));
    }
    // Balthasar van der Pol's oscillator, weak: a circle of radius 2.
    const auto pol =
        radii(with_velocity(skewed(type, nodes, hopf(1)), [](Vec3 x) { return Vec3(x.y, -x.x + 0.1 * (1 - 3 * x.x * x.x) * x.y, 0); }));
    REQUIRE(pol.size() == 1);
    CHECK(pol[0] == doctest::Approx(2 / std::sqrt(3.0)).epsilon(0.04));
  }
}

TEST_CASE("orbits: separatrices that spiral to an orbit end on it") {
  Context context;
  const FlowParts flow(plane_grid(91, 71, -2.4, 2.4, -1.9, 1.9, two_about_three), "", "test", context);
  const CriticalPoints critical = find_critical_points(flow, {}, context);
  auto lines = find_separatrices(flow, critical, {}, {}, context);
  const auto orbits = find_closed_orbits(flow, critical, lines, {}, context);
  end_at_orbits(lines, orbits, context);
  REQUIRE(critical.points.size() == 3);
  size_t at_orbit = 0;
  for (const Separatrix& s : lines) {
    if (s.orbit < 0) continue;
    ++at_orbit;
    CHECK_FALSE(s.unstable);
    CHECK(energy(s.points.back()) == doctest::Approx(0.3).epsilon(0.05));
  }
  CHECK(at_orbit == 2);
}
