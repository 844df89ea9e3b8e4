// SPDX-License-Identifier: Apache-2.0
// Topology across blocks, levels and ghost cells.
#include <numbers>

#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "filter/flow/flow_meshes.h"
#include "filter/flow/topology/topology.h"
#include "filter/flow/topology/topology_support.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::topology;

namespace {

using std::numbers::pi;

Data collection_of(std::vector<DatasetPtr> parts) {
  auto c = std::make_shared<Collection>();
  for (size_t k = 0; k < parts.size(); ++k) c->parts.push_back({"block " + std::to_string(k), parts[k]});
  return CollectionPtr(c);
}

/// [-r,r]^2 in four blocks that share their borders; n cells a side each.
template <class F>
Data four_blocks(size_t n, double r, F&& f) {
  std::vector<DatasetPtr> parts;
  for (const double y : {-r, 0.0})
    for (const double x : {-r, 0.0}) parts.push_back(plane_grid(n + 1, n + 1, x, x + r, y, y + r, f));
  return collection_of(std::move(parts));
}

CriticalPoints zeros_of_parts(const Data& d) {
  Context context;
  const FlowParts flow(d, "", "test", context);
  return find_critical_points(flow, {}, context);
}

/// The same places, classes and indices, whatever their order.
void check_same(const CriticalPoints& a, const CriticalPoints& b, double exact = 1e-10) {
  CHECK(a.points.size() == b.points.size());
  for (const CriticalPoint& p : a.points)
    CHECK(std::any_of(b.points.begin(), b.points.end(),
                      [&](const CriticalPoint& q) { return length(p.at - q.at) < exact && p.index == q.index; }));
}

}  // namespace

TEST_CASE("topology of parts: zeros on the borders of blocks are one, as in a mesh of one piece") {
  const auto nodes = [](Vec3 x) { return Vec3(std::sin(pi * x.x), std::sin(pi * x.y), 0); };  // at all whole numbers
  const CriticalPoints blocks = zeros_of_parts(four_blocks(8, 1, nodes)), whole = zeros_of(plane_grid(17, 17, -1, 1, -1, 1, nodes));
  CHECK(whole.points.size() == 9);
  check_same(whole, blocks);
  const auto edges = [](Vec3 x) { return Vec3(x.x * (0.7 - x.y), x.y - 0.23 + 0.4 * x.x, 0); };  // (0, 0.23) on a side
  check_same(zeros_of(plane_grid(17, 17, -1, 1, -1, 1, edges)), zeros_of_parts(four_blocks(8, 1, edges)));
  // Solids of several kinds side by side.
  for (const Vec3 zero : {Vec3(1, 0.3, 0.4), Vec3(1, 1, 0.4), Vec3(1, 0.5, 0.5), Vec3(0.3, 0.2, 0.1)}) {
    const auto flow = [&](Vec3 x) { return matrix(-1, 2, 0, -2, -1, 0, 0, 0.3, 3) * (x - zero); };
    const DatasetPtr left = with_velocity(sg::test::meshes::solid_box(CellType::hexahedron, 2), flow);
    for (const CellType type : {CellType::hexahedron, CellType::tetra, CellType::polyhedron, CellType::quadratic_hexahedron}) {
      CAPTURE(int(type));
      const DatasetPtr box = sg::test::meshes::solid_box(type, 2);
      const DatasetPtr right = with_velocity(sg::test::flow::moved(box, [](Vec3 p) { return p + Vec3(1, 0, 0); }), flow);
      const CriticalPoints found = zeros_of_parts(collection_of({left, right}));
      REQUIRE(found.points.size() == 1);
      CHECK(length(found.points[0].at - zero) < 1e-10);
      CHECK(found.points[0].flow.type == CriticalType::spiral_saddle_2_in);
    }
  }
}

TEST_CASE("topology of parts: cells that two blocks have, marked or not, count once") {
  const auto flow = [](Vec3 x) { return Vec3(x.x - 0.51, -x.y + 0.21 * x.x, 0); };
  for (const bool marked : {true, false}) {
    DatasetParts left = plane_grid(11, 9, -1, 1, -1, 1, flow)->parts();  // 0.2 a cell
    const DatasetPtr right = plane_grid(9, 9, 0.4, 2, -1, 1, flow);      // from two cells before the end of the left one
    if (marked) {
      std::vector<uint8_t> ghost(80, 0);
      for (size_t c = 0; c < 80; ++c)
        if (c % 10 >= 7) ghost[c] = ghost_duplicate;
      left.cell_ghost = Array::from_vector(ghost);
    }
    const CriticalPoints found = zeros_of_parts(collection_of({make_dataset(left), right}));
    CHECK(found.points.size() == 1);
  }
}

TEST_CASE("topology of parts: an adaptive grid has each zero once, on the borders of its levels too") {
  const DatasetPtr mesh = sg::test::flow::amr_cube(8, 1);  // finer within 0.5
  const Mat3 m = matrix(0.5, 2, 0, -2, 0.5, 0, 0, 0.3, -1);
  for (const Vec3 zero : {Vec3(0.13, 0.2, 0.3), Vec3(0.7, 0.11, -0.3), Vec3(0.5, 0.1, 0.2), Vec3(0.5, 0.5, 0.2), Vec3(0.5, 0.5, 0.5),
                          Vec3(0.5, 0.125, 0.25), Vec3(-0.5, 0.25, 0.5)}) {
    CAPTURE(zero.x);
    CAPTURE(zero.y);
    const auto flow = [&](Vec3 x) { return m * (x - zero); };
    for (const bool marked : {true, false}) {  // the cells under the finer ones
      const CriticalPoints found = zeros_of(marked ? sg::test::flow::with_velocity(mesh, flow) : with_velocity(mesh, flow));
      REQUIRE(found.points.size() == 1);
      CHECK(length(found.points[0].at - zero) < 1e-10);
      CHECK(found.points[0].flow.type == CriticalType::spiral_saddle_1_in);
    }
  }
  // Six in one cell, of the fine level and of the coarse one.
  for (const Vec3 lo : {Vec3(0.25, 0, -0.25), Vec3(0.5, 0.25, 0)}) {
    const double h = lo.x < 0.5 ? 0.125 : 0.25, a[3] = {0.2, 0.5, 0.83}, b[3] = {0.61, 0.15, 0.34}, c[3] = {0.77, 0.4, 0.12};
    const auto product = [&](Vec3 x) {
      const Vec3 u = (x - lo) / h;
      Vec3 f;
      for (int i = 0; i < 3; ++i) f[i] = (u.x - a[i]) * (u.y - b[i]) * (u.z - c[i]);
      return f;
    };
    size_t inside = 0;
    for (const CriticalPoint& p : zeros_of(sg::test::flow::with_velocity(mesh, product)).points) {
      const Vec3 u = (p.at - lo) / h;
      if (std::min({u.x, u.y, u.z}) < 0 || std::max({u.x, u.y, u.z}) > 1) continue;
      ++inside;
      CHECK(length(product(p.at)) < 1e-10);
    }
    CHECK(inside == 6);
  }
}

TEST_CASE("topology of parts: separatrices, orbits and switch points go through blocks as through one mesh") {
  Context context;
  const auto saddle = [](Vec3 x) { return Vec3(x.x - x.x * x.x * x.x + 0.02, -x.y + 0.1 * x.x * x.x, 0); };
  const auto count = [](const CollectionPtr& c, const std::string& part) -> size_t {
    for (const auto& p : c->parts)
      if (p.name == part) {
        const DatasetPtr& d = std::get<DatasetPtr>(p.data);
        return d->as<PointCloud>() ? d->point_count() : d->cell_count();
      }
    return 0;
  };
  const CollectionPtr blocks = topology(four_blocks(12, 1.5, saddle), {}, context),
                      whole = topology(plane_grid(25, 25, -1.5, 1.5, -1.5, 1.5, saddle), {}, context);
  for (const char* part : {"critical points", "separatrices", "closed orbits", "switch points", "border"}) {
    CAPTURE(part);
    CHECK(count(blocks, part) == count(whole, part));
  }
  CHECK(count(blocks, "critical points") == 3);
  CHECK(count(whole, "border") == 4 * 24);
  const FlowParts flow(four_blocks(12, 1.5, saddle), "", "test", context);
  const CriticalPoints critical = find_critical_points(flow, {}, context);
  size_t arrived = 0;
  for (const Separatrix& s : find_separatrices(flow, critical, {}, {}, context)) arrived += s.unstable && s.to >= 0;
  CHECK(arrived == 2);  // sinks in other blocks

  const auto van_der_pol = [](Vec3 x) { return Vec3(x.y, (1 - x.x * x.x) * x.y - x.x, 0); };
  const CollectionPtr cycle = topology(four_blocks(40, 3.5, van_der_pol), {}, context);
  CHECK(count(cycle, "closed orbits") == 1);
}

TEST_CASE("topology of parts: a sphere in two halves has indices that sum to 2") {
  const DatasetPtr ball = sg::test::shapes::sphere(3).dataset();
  std::vector<DatasetPtr> halves;
  for (const bool upper : {true, false}) {
    sg::test::shapes::Builder b;
    CellReader cell(ball);
    for (size_t c = 0; c < cell.count(); ++c) {
      cell.open(c);
      if ((cell.at()[0].z + cell.at()[1].z + cell.at()[2].z > 0) != upper) continue;
      std::vector<int64_t> ids;
      for (const Vec3 p : cell.at()) ids.push_back(b.point(p));  // points of its own for each triangle, moreover
      b.polygon(ids);
    }
    halves.push_back(
        with_velocity(b.dataset(), [](Vec3 x) { return Vec3(std::sin(3 * x.y) + 0.3, std::cos(2 * x.z), std::sin(2 * x.x + 1)); }));
  }
  const CriticalPoints found = zeros_of_parts(collection_of(halves));
  CHECK(found.faces_index == 2);
  CHECK(index_sum(found) == 2);
}

TEST_CASE("topology of parts: the same for any number of threads") {
  Context context;
  const Data d = four_blocks(20, 3, [](Vec3 x) { return Vec3(std::sin(2 * x.y), std::cos(2 * x.x) + 0.1 * x.y, 0); });
  set_thread_count(1);
  const CollectionPtr one = topology(d, {}, context);
  set_thread_count(8);
  const CollectionPtr eight = topology(d, {}, context);
  set_thread_count(0);
  REQUIRE(one->parts.size() == eight->parts.size());
  for (size_t k = 0; k < one->parts.size(); ++k) {
    const DatasetPtr &a = std::get<DatasetPtr>(one->parts[k].data), &b = std::get<DatasetPtr>(eight->parts[k].data);
    for (const Field& f : a->fields()) CHECK(sg::test::meshes::same_bytes(f.array, b->fields().require(f.name).array));
  }
}
