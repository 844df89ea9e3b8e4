// SPDX-License-Identifier: Apache-2.0
// Lines through every kind of mesh (correctness.md F1, F2).
#include <numbers>

#include "filter/every_mesh.h"
#include "filter/flow/streamlines.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::flow;

namespace {

using std::numbers::pi;

// A spiral about the z axis: x' = A x with x(t) = e^{-t/10} R(t) x0, z(t) = z0 e^{-t/5}.
Vec3 spiral(Vec3 p) { return {-0.1 * p.x - p.y, p.x - 0.1 * p.y, -0.2 * p.z}; }
Vec3 spiral_at(Vec3 p, double t) {
  const double e = std::exp(-t / 10), c = std::cos(t), s = std::sin(t);
  return {e * (c * p.x - s * p.y), e * (s * p.x + c * p.y), std::exp(-t / 5) * p.z};
}

// psi = sin x sin y, the stream function of Taylor-Green vortices.
double vortex_psi(Vec3 p) { return std::sin(p.x) * std::sin(p.y); }
Vec3 vortex(Vec3 p) { return {std::sin(p.x) * std::cos(p.y), -std::cos(p.x) * std::sin(p.y), 0}; }

Vec3 seed_in(const MeshKind& kind) { return {0.55, -0.21, kind.flat ? 0 : 0.37}; }

TraceOptions timed(Scheme scheme, double step, double time) {
  TraceOptions o;
  o.scheme = scheme, o.unit = StepUnit::time, o.step = step, o.max_time = time, o.closed = false, o.max_steps = 100000;
  return o;
}

}  // namespace

TEST_CASE("flow meshes: a linear flow is followed exactly in every kind of mesh (F1)") {
  for (const MeshKind& kind : every_mesh()) {
    CAPTURE(kind.name);
    const DatasetPtr mesh = with_velocity(kind.make(6, 1), spiral);
    const Vec3 seed = seed_in(kind);
    TraceOptions o;
    o.max_time = 3, o.tolerance = 1e-9, o.min_step = 1e-4, o.max_step = 0.5;
    const TracedLines l = line_from(mesh, seed, o);
    REQUIRE(l.lines() == 1);
    CHECK(l.stop[0] == StopReason::time);
    CHECK(l.time.back() == doctest::Approx(3));
    double worst = 0, slower = 0;
    for (size_t i = 0; i < l.points.size(); ++i) {
      worst = std::max(worst, length(l.points[i] - spiral_at(seed, l.time[i])));
      slower = std::max(slower, length(l.velocity[i] - spiral(l.points[i])));
    }
    CHECK(worst < 2e-8);
    CHECK(slower < 1e-9);
  }
}

TEST_CASE("flow meshes: fixed steps have the order of their scheme in every kind of mesh (F1)") {
  for (const MeshKind& kind : every_mesh()) {
    CAPTURE(kind.name);
    const DatasetPtr mesh = with_velocity(kind.make(6, 1), spiral);
    const Vec3 seed = seed_in(kind);
    for (const Scheme s : {Scheme::euler, Scheme::midpoint, Scheme::heun, Scheme::rk4}) {
      double h[4], error[4];
      for (int k = 0; k < 4; ++k) {
        h[k] = 0.2 / (1 << k);
        error[k] = length(line_from(mesh, seed, timed(s, h[k], 2)).points.back() - spiral_at(seed, 2));
      }
      CHECK(observed_order(h, error, 4) == doctest::Approx(order_of(s)).epsilon(0.2 / order_of(s)));
    }
  }
}

TEST_CASE("flow meshes: a rotation closes after 2 pi in every kind of mesh (F1)") {
  for (const MeshKind& kind : every_mesh()) {
    CAPTURE(kind.name);
    const DatasetPtr mesh = with_velocity(kind.make(6, 1), rotation);
    TraceOptions o;
    o.tolerance = 1e-6;
    const Vec3 seed(0.53, 0.11, kind.flat ? 0 : 0.2);
    const TracedLines l = line_from(mesh, seed, o, TraceDirection::both);
    REQUIRE(l.lines() == 1);
    CHECK(l.stop[0] == StopReason::closed);
    CHECK(std::abs(l.time.back() - l.time.front()) == doctest::Approx(2 * pi).epsilon(1e-5));
    CHECK(length(l.points.back() - l.points.front()) < 1e-12);
  }
}

TEST_CASE("flow meshes: psi of a linear flow drifts with the order of the scheme in every kind of mesh (F2)") {
  // psi = x^2/2 + 2y^2: ellipses, exact in the cells, so that all drift is that of the steps.
  const auto psi = [](Vec3 p) { return p.x * p.x / 2 + 2 * p.y * p.y; };
  for (const MeshKind& kind : every_mesh()) {
    CAPTURE(kind.name);
    const DatasetPtr mesh = with_velocity(kind.make(6, 1), [](Vec3 p) { return Vec3(4 * p.y, -p.x, 0); });
    double h[4], drift[4];
    for (int k = 0; k < 4; ++k) {
      h[k] = 0.2 / (1 << k), drift[k] = 0;
      const TracedLines l = line_from(mesh, {0.6, 0.1, kind.flat ? 0 : 0.05}, timed(Scheme::rk4, h[k], 4));
      REQUIRE(l.stop[0] == StopReason::time);
      for (const Vec3& p : l.points) drift[k] = std::max(drift[k], std::abs(psi(p) - psi(l.points[0])));
    }
    CHECK(observed_order(h, drift, 4) > 3.8);
    CHECK(drift[3] < 1e-6);
  }
}

TEST_CASE("flow meshes: psi of Taylor-Green vortices is kept as well as every kind of mesh holds the flow (F2)") {
  for (const MeshKind& kind : every_mesh()) {
    CAPTURE(kind.name);
    double drift[2];
    for (int k = 0; k < 2; ++k) {
      const int n = 6 << k;
      drift[k] = 0;
      // One vortex about (pi/2, pi/2), as the middle of the mesh.
      const Vec3 middle(pi / 2, pi / 2, 0);
      const DatasetPtr mesh = with_velocity(kind.make(n, 1.6), [&](Vec3 p) { return vortex(p + middle); });
      const TracedLines l = line_from(mesh, {0.7, 0.2, kind.flat ? 0 : 0.1}, timed(Scheme::rk4, 0.05, 5));
      REQUIRE(l.stop[0] == StopReason::time);
      for (const Vec3& p : l.points) drift[k] = std::max(drift[k], std::abs(vortex_psi(p + middle) - vortex_psi(l.points[0] + middle)));
    }
    CHECK(std::log2(drift[0] / drift[1]) > 1.6);
    CHECK(drift[1] < 0.02);
  }
}

TEST_CASE("flow meshes: a slow spiral is not taken for a closed line") {
  const DatasetPtr mesh = with_velocity(make_dataset(uniform_cube(9, 1)), [](Vec3 p) { return rotation(p) - 2e-4 * p; });
  TraceOptions o;
  o.tolerance = 1e-7, o.max_time = 20;
  CHECK(line_from(mesh, {0.5, 0, 0}, o).stop[0] == StopReason::time);
}

TEST_CASE("flow meshes: the stream function of a flow of degree three drifts with the order of the scheme") {
  // psi = (1 - x^2)(1 - y^2) / 2: its velocity lies in the space of the cells.
  const auto psi = [](Vec3 p) { return (1 - p.x * p.x) * (1 - p.y * p.y) / 2; };
  const auto u = [](Vec3 p) { return Vec3(-p.y * (1 - p.x * p.x), p.x * (1 - p.y * p.y), 0); };
  const DatasetPtr mesh = with_velocity(mesh_of("lagrange hexahedron", 4, 1), u);
  double h[3], drift[3];
  for (int k = 0; k < 3; ++k) {
    h[k] = 0.3 / (1 << k), drift[k] = 0;
    const TracedLines l = line_from(mesh, {0.6, 0.1, 0.05}, timed(Scheme::rk4, h[k], 9));
    for (const Vec3& p : l.points) drift[k] = std::max(drift[k], std::abs(psi(p) - psi(l.points[0])));
  }
  CHECK(observed_order(h, drift, 3) > 3.8);
  CHECK(drift[2] < 1e-5);
}

TEST_CASE("flow meshes: the double gyre's stream function is kept as well as the grid holds the flow") {
  // The interpolated flow leaves psi by the square of the spacing.
  double h[3], drift[3];
  for (int k = 0; k < 3; ++k) {
    const size_t n = size_t(16) << k;
    h[k] = 1.0 / double(n), drift[k] = 0;
    const auto psi = [](Vec3 p) { return std::sin(pi * p.x) * std::sin(pi * p.y); };
    const auto u = [](Vec3 p) { return Vec3(std::sin(pi * p.x) * std::cos(pi * p.y), -std::cos(pi * p.x) * std::sin(pi * p.y), 0); };
    const DatasetPtr mesh = with_velocity(make_dataset(uniform({2 * n + 1, n + 1, 1}, {0, 0, 0}, {2, 1, 0})), u);
    const TracedLines l = line_from(mesh, {0.31, 0.42, 0}, timed(Scheme::rk4, 0.02, 5));
    for (const Vec3& p : l.points) drift[k] = std::max(drift[k], std::abs(psi(p) - psi(l.points[0])));
  }
  CHECK(observed_order(h, drift, 3) > 1.8);
  CHECK(drift[2] < 5e-4);
}

TEST_CASE("flow meshes: lines of a rotation stay on a sphere and close") {
  const DatasetPtr mesh = with_velocity(shapes::sphere(4).dataset(), rotation);
  for (const Vec3 seed : {normalize(Vec3(1, 0, 0.1)), Vec3(0.6, 0, 0.8), Vec3(0, 0.8, -0.6)}) {
    TraceOptions o;
    o.tolerance = 1e-4;
    const TracedLines l = line_from(mesh, seed, o);
    REQUIRE(l.lines() == 1);
    CHECK(l.stop[0] == StopReason::closed);
    for (const Vec3& p : l.points) {
      CHECK(length(p) == doctest::Approx(1).epsilon(3e-3));
      CHECK(p.z == doctest::Approx(seed.z).epsilon(1e-2));
    }
    // The facets are not turned into each other by the rotation: it may take a second turn.
    const double turns = l.arc.back() / (2 * pi * std::hypot(seed.x, seed.y));
    CHECK(std::abs(turns - std::nearbyint(turns)) < 1e-2);
    CHECK(turns < 3);
  }
}

TEST_CASE("flow meshes: flat meshes of every kind are left at their border") {
  for (const MeshKind& kind : flat_meshes()) {
    CAPTURE(kind.name);
    const DatasetPtr mesh = with_velocity(kind.make(8, 1), rotation);
    TraceOptions o;
    o.tolerance = 1e-7;
    const TracedLines l = line_from(mesh, {0.41, 0.13, 0}, o);
    REQUIRE(l.lines() == 1);
    for (const Vec3& p : l.points) CHECK(std::hypot(p.x, p.y) == doctest::Approx(std::hypot(0.41, 0.13)).epsilon(1e-5));
    // Out at the corner: the circle meets the border at x = 1.
    const TracedLines out = line_from(mesh, {0.9, -0.8, 0}, o);
    CHECK(out.stop[0] == StopReason::outside);
    CHECK(out.points.back().x == doctest::Approx(1).epsilon(0.01));  // a hundredth of a cell
    CHECK(length(out.points.back()) == doctest::Approx(std::hypot(0.9, 0.8)).epsilon(1e-4));
  }
}

TEST_CASE("flow meshes: lines cross from part to part as if there were one mesh") {
  const auto u = [](Vec3 p) { return Vec3(1, 0.3 * p.x, 0.2 * p.y); };
  const DatasetPtr whole = with_velocity(make_dataset(uniform({17, 9, 9}, {-2, -1, -1}, {2, 1, 1})), u);
  auto parts = std::make_shared<Collection>();
  parts->parts.push_back({"left", with_velocity(make_dataset(uniform({9, 9, 9}, {-2, -1, -1}, {0, 1, 1})), u)});
  parts->parts.push_back({"wall", with_velocity(shapes::sphere(1).dataset(), [](Vec3) { return Vec3(); })});
  parts->parts.push_back({"right", with_velocity(solid_mesh("tetra", 4, 1, [](Vec3) { return 0.0; }), u)});
  // The tetrahedra lie over [-1,1]^3 and overlap the left part; what is right of them is missing.
  Context context;
  const FlowParts flow(parts, "", "test", context);
  CHECK(flow.count() == 2);
  TraceOptions o;
  o.tolerance = 1e-8;
  const Vec3 seeds[] = {{-1.9, 0.1, 0.1}};
  const TracedLines a = trace_lines(FlowParts(whole, "", "test", context), seeds, TraceDirection::forward, o, context);
  const TracedLines b = trace_lines(flow, seeds, TraceDirection::forward, o, context);
  REQUIRE(b.lines() == 1);
  CHECK(b.stop[0] == StopReason::outside);
  CHECK(b.points.back().x == doctest::Approx(1).epsilon(5e-3));
  const auto exact = [&](double t) {  // x = x0 + t and so on, by hand
    const double x0 = -1.9, y0 = 0.1, z0 = 0.1;
    return Vec3(x0 + t, y0 + 0.3 * (x0 * t + t * t / 2), z0 + 0.2 * (y0 * t + 0.3 * (x0 * t * t / 2 + t * t * t / 6)));
  };
  for (size_t i = 0; i < b.points.size(); ++i) CHECK(length(b.points[i] - exact(b.time[i])) < 1e-7);
  for (size_t i = 0; i < a.points.size(); ++i) CHECK(length(a.points[i] - exact(a.time[i])) < 1e-7);
}
