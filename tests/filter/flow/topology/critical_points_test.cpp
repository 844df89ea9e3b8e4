// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/critical_points.h"

#include "base/parallel.h"
#include "base/random.h"
#include "filter/cell_meshes.h"
#include "filter/flow/topology/topology_support.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::topology;
using namespace sg::test::meshes;

namespace {

// Four classes of the plane about one place.
const std::vector<std::pair<Mat3, CriticalType>>& plane_flows() {
  static const std::vector<std::pair<Mat3, CriticalType>> flows{{matrix(1, 0.3, 0, 0.2, -2, 0, 0, 0, 0), CriticalType::saddle},
                                                                {matrix(-1, 0.3, 0, 0.2, -2, 0, 0, 0, 0), CriticalType::attracting_node},
                                                                {matrix(1, 0.3, 0, 0.2, 2, 0, 0, 0, 0), CriticalType::repelling_node},
                                                                {matrix(-0.2, 1, 0, -2, -0.2, 0, 0, 0, 0), CriticalType::attracting_focus},
                                                                {matrix(0.2, 1, 0, -2, 0.2, 0, 0, 0, 0), CriticalType::repelling_focus},
                                                                {matrix(0.5, 1, 0, -2, -0.5, 0, 0, 0, 0), CriticalType::centre}};
  return flows;
}

const std::vector<std::pair<Mat3, CriticalType>>& solid_flows() {
  static const std::vector<std::pair<Mat3, CriticalType>> flows{
      {matrix(-1, 0.3, 0, 0.1, -2, 0, 0.2, 0, -3), CriticalType::attracting_node},
      {matrix(1, 0.3, 0, 0.1, 2, 0, 0.2, 0, 3), CriticalType::repelling_node},
      {matrix(-1, 2, 0, -2, -1, 0, 0, 0.3, -3), CriticalType::attracting_focus},
      {matrix(1, 2, 0, -2, 1, 0, 0, 0.3, 1), CriticalType::repelling_focus},
      {matrix(-1, 0.3, 0, 0.1, 2, 0, 0.2, 0, 3), CriticalType::saddle_1_in},
      {matrix(-1, 0.3, 0, 0.1, -2, 0, 0.2, 0, 3), CriticalType::saddle_2_in},
      {matrix(0.5, 2, 0, -2, 0.5, 0, 0, 0.3, -1), CriticalType::spiral_saddle_1_in},
      {matrix(-0.5, 2, 0, -2, -0.5, 0, 0, 0.3, 1), CriticalType::spiral_saddle_2_in}};
  return flows;
}

void check_one(const DatasetPtr& mesh, const std::vector<std::pair<Mat3, CriticalType>>& flows, Vec3 zero, double exact = 1e-10) {
  for (const auto& [m, type] : flows) {
    const CriticalPoints found = zeros_of(with_velocity(mesh, [&, m = m](Vec3 x) { return m * (x - zero); }));
    CHECK(found.points.size() == 1);
    if (found.points.size() != 1) continue;
    CHECK(length(found.points[0].at - zero) < exact);
    CHECK(found.points[0].flow.type == type);
    double worst = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) worst = std::max(worst, std::abs(found.points[0].gradient.m[i][j] - m.m[i][j]));
    CHECK(worst < 1e-6);
  }
}

// Newton's method from a dense grid of starts: slow, and it misses little.
std::vector<Vec3> oracle(const std::vector<Vec3>& v, int d) {
  std::vector<Vec3> found;
  const int n = d == 3 ? 9 : 25;
  for (int s = 0; s < (d == 3 ? n * n * n : n * n); ++s) {
    Vec3 u((s % n + 0.5) / n, (s / n % n + 0.5) / n, d == 3 ? (s / n / n + 0.5) / n : 0);
    bool good = false;
    for (int round = 0; round < 40; ++round) {
      Vec3 f, g[3] = {{}, {}, {0, 0, d == 2 ? 1.0 : 0.0}};
      for (size_t c = 0; c < v.size(); ++c) {
        const double x[3] = {c & 1 ? u.x : 1 - u.x, c & 2 ? u.y : 1 - u.y, d == 2 ? 1 : c & 4 ? u.z : 1 - u.z};
        const double s3[3] = {c & 1 ? 1.0 : -1.0, c & 2 ? 1.0 : -1.0, c & 4 ? 1.0 : -1.0};
        f += v[c] * (x[0] * x[1] * x[2]);
        for (int a = 0; a < d; ++a) g[a] += v[c] * (s3[a] * x[(a + 1) % 3] * x[(a + 2) % 3]);
      }
      const Vec3 bc = cross(g[1], g[2]);
      const double det = dot(g[0], bc);
      if (det == 0) break;
      const Vec3 move(-dot(f, bc) / det, -dot(g[0], cross(f, g[2])) / det, d == 3 ? -dot(g[0], cross(g[1], f)) / det : 0);
      u += move;
      if (length(move) < 1e-13) {
        good = true;
        break;
      }
      if (length(u) > 10) break;
    }
    if (!good || std::min({u.x, u.y, u.z}) < 0 || std::max({u.x, u.y, u.z}) > 1) continue;
    if (std::none_of(found.begin(), found.end(), [&](Vec3 p) { return length(p - u) < 1e-9; })) found.push_back(u);
  }
  return found;
}

DatasetPtr one_box(const std::vector<Vec3>& v, int d) {
  UniformGrid g;
  g.dims = {2, 2, d == 3 ? 2u : 1u};
  std::vector<double> x;
  for (const Vec3 u : v) x.insert(x.end(), {u.x, u.y, u.z});
  FieldSet fields;
  fields.add({"velocity", Association::point, Array::from_vector(std::move(x), 3), "", Role::vectors});
  return make_dataset(g, std::move(fields));
}

// Each zero of the oracle is found, and nothing else.
size_t compare(const std::vector<Vec3>& v, int d) {
  const auto expected = oracle(v, d);
  const CriticalPoints found = zeros_of(one_box(v, d));
  CHECK(found.points.size() >= expected.size());
  for (const Vec3 e : expected)
    CHECK(std::any_of(found.points.begin(), found.points.end(), [&](const CriticalPoint& c) { return length(c.at - e) < 1e-10; }));
  for (const CriticalPoint& c : found.points) {
    Vec3 f;
    for (size_t k = 0; k < v.size(); ++k)
      f += v[k] * ((k & 1 ? c.at.x : 1 - c.at.x) * (k & 2 ? c.at.y : 1 - c.at.y) * (d == 2 ? 1 : k & 4 ? c.at.z : 1 - c.at.z));
    CHECK(length(f) < 1e-10);
  }
  return expected.size();
}

}  // namespace

TEST_CASE("critical points: a linear flow has one zero of its class on every kind of flat mesh") {
  const Vec3 zero(0.137, -0.211, 0);
  auto same = [](Vec3 p) { return p; };
  auto bent = [](Vec3 p) { return p + 0.05 * Vec3(std::sin(3 * p.y), std::sin(2 * p.x), 0); };
  using enum CellType;
  SUBCASE("uniform") {
    check_one(plane_grid(9, 7, -1, 1, -1, 1, [](Vec3) { return Vec3(); }), plane_flows(), zero);
  }
  SUBCASE("rectilinear") {
    RectilinearGrid g;
    g.x = Array::from_vector(std::vector<double>{-1, -0.5, 0.1, 0.4, 1});
    g.y = Array::from_vector(std::vector<double>{1, 0.3, -0.3, -1});
    g.z = Array::from_vector(std::vector<double>{0});
    check_one(make_dataset(g), plane_flows(), zero);
  }
  SUBCASE("curvilinear") {
    CurvilinearGrid g;
    g.dims = {7, 6, 1};
    std::vector<double> xyz;
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 7; ++i) {
        const Vec3 p = bent({-1 + i / 3.0, -1 + j / 2.5, 0});
        xyz.insert(xyz.end(), {p.x, p.y, p.z});
      }
    g.points.xyz = Array::from_vector(std::move(xyz), 3);
    check_one(make_dataset(g), plane_flows(), zero);
  }
  SUBCASE("cells") {
    for (const auto& [type, nodes] : std::vector<std::pair<CellType, size_t>>{{triangle, 3},
                                                                              {quad, 4},
                                                                              {pixel, 4},
                                                                              {polygon, 4},
                                                                              {triangle_strip, 4},
                                                                              {quadratic_triangle, 6},
                                                                              {quadratic_quad, 8},
                                                                              {biquadratic_quad, 9},
                                                                              {lagrange_quad, 16},
                                                                              {lagrange_triangle, 10},
                                                                              {bezier_quad, 9},
                                                                              {bezier_triangle, 6}}) {
      CAPTURE(int(type));
      check_one(plane_cells(type, nodes, 4, same), plane_flows(), zero);
    }
    for (const CellType type : {quad, polygon}) check_one(plane_cells(type, 4, 5, bent), plane_flows(), zero);
  }
  SUBCASE("zeros on edges and points are one") {
    for (const auto& [type, nodes] : std::vector<std::pair<CellType, size_t>>{
             {triangle, 3}, {quad, 4}, {pixel, 4}, {polygon, 4}, {triangle_strip, 4}, {lagrange_quad, 9}, {quadratic_triangle, 6}}) {
      CAPTURE(int(type));
      check_one(plane_cells(type, nodes, 4, same), plane_flows(), {0, 0, 0});
      check_one(plane_cells(type, nodes, 4, same), plane_flows(), {0.5, 0.13, 0});
    }
  }
}

TEST_CASE("critical points: a linear flow has one zero of its class on every kind of solid mesh") {
  const Vec3 zero(0.437, 0.611, 0.323);
  for (const std::string& kind : sg::test::solid_kinds()) {
    CAPTURE(kind);
    auto none = [](Vec3) { return 0.0; };
    check_one(sg::test::solid_mesh(kind, 3, 1, none), solid_flows(), {0.137, -0.211, 0.3}, 1e-9);
    check_one(sg::test::solid_mesh(kind, 3, 1, none, kind == "polyhedron" || kind == "mixed" ? 0 : 0.05), solid_flows(),
              {0.137, -0.211, 0.3}, 1e-9);
    check_one(sg::test::solid_mesh(kind, 2, 1, none), solid_flows(), {0, 0, 0}, 1e-9);  // a point of the mesh
  }
  for (const CellType type : curved_solids()) {
    CAPTURE(int(type));
    check_one(solid_box(type, 2, 2), solid_flows(), zero);
    if (type >= CellType::lagrange_curve) check_one(solid_box(type, 1, 3), {solid_flows()[6]}, zero);
  }
  check_one(uniform_box(4, 5, 6), solid_flows(), zero);
  check_one(uniform_box(4, 5, 6), solid_flows(), {0.5, 0.2, 0.5});
}

TEST_CASE("critical points: in a tilted plane the part of the velocity in the plane counts") {
  const Vec3 e1 = normalize(Vec3(1, 2, 0.5)), n = normalize(cross(e1, Vec3(0.1, 0, 1))), e2 = cross(n, e1);
  const DatasetPtr mesh = plane_cells(CellType::quad, 4, 6, [&](Vec3 p) { return Vec3(5, 6, 7) + p.x * e1 + p.y * e2; });
  const CriticalPoints found = zeros_of(with_velocity(mesh, [&](Vec3 x) {
    const double a = dot(x - Vec3(5, 6, 7), e1) - 0.21, b = dot(x - Vec3(5, 6, 7), e2) + 0.32;
    return (-0.1 * a + b) * e1 + (-a - 0.1 * b) * e2 + 3 * n;
  }));
  REQUIRE(found.points.size() == 1);
  CHECK(found.points[0].flow.type == CriticalType::attracting_focus);
  CHECK(length(found.points[0].at - (Vec3(5, 6, 7) + 0.21 * e1 - 0.32 * e2)) < 1e-10);
}

TEST_CASE("critical points: all zeros of random bilinear cells, as by brute force") {
  size_t zeros = 0, twice = 0;
  for (uint64_t s = 0; s < 400; ++s) {
    std::vector<Vec3> v;
    for (uint64_t c = 0; c < 4; ++c) v.emplace_back(2 * random_unit(s, 2 * c) - 1, 2 * random_unit(s, 2 * c + 1) - 1, 0);
    const size_t n = compare(v, 2);
    zeros += n, twice += n == 2;
  }
  CHECK(zeros > 50);
  CHECK(twice > 3);
}

TEST_CASE("critical points: all zeros of random trilinear cells, as by brute force, to 1e-10") {
  size_t zeros = 0, several = 0;
  for (uint64_t s = 0; s < 150; ++s) {
    std::vector<Vec3> v;
    for (uint64_t c = 0; c < 8; ++c)
      v.emplace_back(2 * random_unit(s, 3 * c) - 1, 2 * random_unit(s, 3 * c + 1) - 1, 2 * random_unit(s, 3 * c + 2) - 1);
    const size_t n = compare(v, 3);
    zeros += n, several += n > 1;
  }
  CHECK(zeros > 30);
  CHECK(several > 3);
}

TEST_CASE("critical points: the Taylor-Green vortices have their centres and saddles where they are known") {
  const CriticalPoints found = zeros_of(plane_grid(38, 42, 0.3, 6.8, 0.2, 6.9, taylor_green), 0.05);
  size_t expected = 0;
  for (int k = 0; k <= 4; ++k)
    for (int l = 0; l <= 4; ++l) {
      if ((k + l) % 2) continue;
      const Vec3 at(k * M_PI / 2, l * M_PI / 2, 0);
      if (at.x < 0.3 || at.x > 6.8 || at.y < 0.2 || at.y > 6.9) continue;
      ++expected;
      const CriticalType type = k % 2 == 0 ? CriticalType::centre : CriticalType::saddle;
      CHECK(std::any_of(found.points.begin(), found.points.end(), [&](const CriticalPoint& c) {
        return length(c.at - at) < 0.01 && c.flow.type == type && c.index == (k % 2 ? -1 : 1);
      }));
    }
  CHECK(found.points.size() == expected);
}

TEST_CASE("critical points: the double gyre has two centres, and saddles on its border") {
  for (const double swing : {0.0, 0.25}) {
    const CriticalPoints found = zeros_of(plane_grid(64, 33, 0, 2, 0, 1, [&](Vec3 x) { return double_gyre(x, swing); }), 0.02);
    CHECK(count_of(found, CriticalType::centre) == 2);
    CHECK(count_of(found, CriticalType::saddle) == found.points.size() - 2);
    CHECK(found.points.size() == 8);
  }
}

TEST_CASE("critical points: the ABC flow of equal parts stands still at points of index sum 0, to second order") {
  double error[2], h[2];
  for (int k = 0; k < 2; ++k) {
    const size_t n = k ? 45 : 23;
    const double from = 0.4321;  // so that no zero lies on the border of the period
    const CriticalPoints found = zeros_of(cube_grid(n, from, from + 2 * M_PI, abc));
    CHECK(found.points.size() == 8);
    CHECK(index_sum(found) == 0);
    error[k] = 0, h[k] = 1.0 / double(n - 1);
    for (const CriticalPoint& c : found.points) error[k] = std::max(error[k], length(abc(c.at)));
  }
  CHECK(sg::test::observed_order(h, error, 2) > 1.6);
}

TEST_CASE("critical points: zero fields, areas and lines of zeros are no points") {
  auto grid = [](auto f) { return plane_grid(9, 9, -1, 1, -1, 1, f); };
  CHECK(zeros_of(grid([](Vec3) { return Vec3(); })).points.empty());
  CHECK(zeros_of(grid([](Vec3) { return Vec3(); })).spread == 64);
  CHECK(zeros_of(grid([](Vec3 x) { return Vec3(x.y - 0.1, 0, 0); })).points.empty());
  CHECK(zeros_of(grid([](Vec3 x) { return Vec3(x.x, x.x, 0); })).points.empty());
  // Still on one half, a saddle in the other.
  const CriticalPoints half = zeros_of(grid([](Vec3 x) { return x.x <= 0 ? Vec3() : Vec3(x.x * (x.x - 0.6), -x.x * (x.y - 0.1), 0); }));
  CHECK(half.points.size() == 1);
  CHECK(half.spread > 0);
  // A plane flow in a solid has lines of zeros; no-slip walls have areas of them.
  const CriticalPoints lines = zeros_of(with_velocity(uniform_box(4, 4, 4), [](Vec3 x) { return Vec3(x.x - 0.4, x.y - 0.4, 0); }));
  CHECK(lines.points.empty());
  CHECK(lines.spread > 0);
  const CriticalPoints wall = zeros_of(with_velocity(uniform_box(4, 4, 4), [](Vec3 x) {
    const double s = x.z * (1 - x.z);
    return s * Vec3(x.x - 0.4, 0.45 - x.y, x.z - 0.6);
  }));
  CHECK(wall.points.size() == 1);
}

TEST_CASE("critical points: cells with NaN and hidden cells have none") {
  const DatasetPtr d =
      plane_grid(5, 5, -1, 1, -1, 1, [](Vec3 x) { return std::abs(x.x) + std::abs(x.y) < 0.1 ? Vec3(NAN, 0, 0) : x - Vec3(0.1, 0.1, 0); });
  CHECK(zeros_of(d).points.empty());
  DatasetParts parts = plane_grid(5, 5, -1, 1, -1, 1, [](Vec3 x) { return x - Vec3(0.1, 0.1, 0); })->parts();
  CHECK(zeros_of(make_dataset(parts)).points.size() == 1);
  std::vector<uint8_t> ghost(16, 0);
  ghost[10] = ghost_hidden_cell;
  parts.cell_ghost = Array::from_vector(ghost);
  CHECK(zeros_of(make_dataset(parts)).points.empty());
}

TEST_CASE("critical points: cells that are slower than asked for are left out") {
  const DatasetPtr d = plane_grid(
      33, 9, -1, 1, -0.25, 0.25, [](Vec3 x) { return x.x < 0 ? 1e-3 * Vec3(x.x + 0.51, x.y - 0.01, 0) : Vec3(x.x - 0.51, x.y - 0.01, 0); });
  Context context;
  const FlowField flow(d, "", context);
  CHECK(find_critical_points(flow, {}, context).points.size() == 3);  // one where both parts meet
  const CriticalPoints fast = find_critical_points(flow, {.min_speed = 0.01}, context);
  REQUIRE(fast.points.size() == 2);
  for (const auto& c : fast.points) CHECK(c.at.x > -0.1);
}

TEST_CASE("critical points: the same for any number of threads and any order of the cells") {
  Context context;
  const DatasetPtr d = cube_grid(30, 0, 2 * M_PI, abc);
  set_thread_count(1);
  const DatasetPtr one = critical_points(d, {}, context);
  set_thread_count(8);
  const DatasetPtr eight = critical_points(d, {}, context);
  set_thread_count(0);
  REQUIRE(one->point_count() > 4);
  for (const Field& f : one->fields()) CHECK(same_bytes(f.array, eight->fields().require(f.name).array));
  // Cells from the last to the first.
  auto flow = [](Vec3 x) { return Vec3(std::sin(4 * x.y), std::cos(4 * x.x), 0); };
  const DatasetPtr plane = with_velocity(plane_cells(CellType::triangle, 3, 12, [](Vec3 x) { return x; }), flow);
  DatasetParts parts = plane->parts();
  auto mesh = std::get<UnstructuredMesh>(parts.mesh);
  std::vector<int64_t> ids;
  for (size_t c = mesh.cells.size(); c-- > 0;)
    for (int k = 0; k < 3; ++k) ids.push_back(int64_t(mesh.cells.connectivity.get(3 * c + size_t(k))));
  mesh.cells.connectivity = Array::from_vector(ids);
  parts.mesh = mesh;
  const CriticalPoints a = zeros_of(plane), b = zeros_of(make_dataset(parts));
  CHECK(a.points.size() == b.points.size());
  CHECK(a.points.size() > 3);
  for (const auto& c : a.points)
    CHECK(std::any_of(b.points.begin(), b.points.end(),
                      [&](const auto& e) { return length(c.at - e.at) < 1e-10 && c.flow.type == e.flow.type; }));
}

TEST_CASE("critical points: what is wrong with the input is said") {
  Context context;
  auto said = [&](const DatasetPtr& d, CriticalPointsParams p = {}) { return sg::test::error_of([&] { critical_points(d, p, context); }); };
  CHECK(said(uniform_box(2, 2, 2)).find("no vector field") != std::string::npos);
  CHECK(said(uniform_box(2, 2, 2), {{"f"}}).find("1 component") != std::string::npos);
  CHECK(said(with_velocity(uniform_box(4, 0, 0), [](Vec3 x) { return x; })).find("no cells with area") != std::string::npos);
}
