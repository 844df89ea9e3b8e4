// SPDX-License-Identifier: Apache-2.0
// Walking from cell to cell against searching: the same answers in every kind of mesh.
#include "base/random.h"
#include "data/memory/memo.h"
#include "filter/flow/flow_meshes.h"
#include "filter/flow/flow_parts.h"
#include "index/locator_meshes.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::flow;

namespace {

Vec3 wavy(Vec3 p) { return {std::sin(3 * p.y) + 0.3 * p.x, std::cos(2 * p.z) * p.x, std::sin(2 * p.x + p.y)}; }

Vec3 random_vec(uint64_t k) {
  return {2 * random_unit(7, 3 * k) - 1, 2 * random_unit(7, 3 * k + 1) - 1, 2 * random_unit(7, 3 * k + 2) - 1};
}

// Random short steps: the cursor, which walks, against a locator that is asked anew and takes the smallest cell.
// `conforming`: cells agree where they meet; else the cell that the walk is in counts, if it holds the place.
void compare(const DatasetPtr& mesh, size_t steps, double step, bool conforming = true, double epsilon = 1e-12) {
  Context context;
  const FlowField field(mesh, "u", context);
  FlowCursor walk(field);
  LocatorCursor search(*field.locator());
  CellMap own(mesh);
  const Box3 box = mesh->bounds();
  Vec3 x = box.center();
  size_t inside = 0, differ = 0, other_cell = 0;
  double worst = 0;
  for (size_t n = 0; n < steps; ++n) {
    Vec3 next = x + step * random_vec(n);
    for (int a = 0; a < 3; ++a) {  // back at the sides, now and then a little beyond them
      const double slack = 0.02 * (box.hi[a] - box.lo[a]);
      if (next[a] < box.lo[a] - slack || next[a] > box.hi[a] + slack) next[a] = x[a];
    }
    if (n % 997 == 996)
      next = box.center() + 0.5 * Vec3(box.size().x * random_vec(n).x, box.size().y * random_vec(n).y, box.size().z * random_vec(n).z);
    x = next;
    Vec3 v;
    const bool here = walk(x, v);
    const int64_t c = search.find(x);
    differ += here != (c >= 0);
    if (!here || c < 0) continue;
    ++inside;
    other_cell += walk.cell() != c;
    Vec3 want, again;
    if (walk.cell() != c && !conforming) {
      own.open(size_t(walk.cell()));
      CellPlace place;
      differ += !own.locate(x, place, 1e-8);
      std::vector<double> weights(own.reader().ids().size());
      own.weights(place, weights);
      for (size_t k = 0; k < weights.size(); ++k) want += field.at_point(size_t(own.reader().ids()[k])) * weights[k];
      worst = std::max(worst, length(v - want));
      continue;
    }
    for (size_t k = 0; k < search.ids().size(); ++k) want += field.at_point(size_t(search.ids()[k])) * search.weights()[k];
    worst = std::max(worst, length(v - want));
    for (size_t k = 0; k < walk.ids().size(); ++k) again += field.at_point(size_t(walk.ids()[k])) * walk.weights()[k];
    worst = std::max(worst, length(again - want));
  }
  CHECK(inside > steps / 3);
  CHECK(differ == 0);
  CHECK(worst < epsilon);
  if (conforming) CHECK(other_cell < inside / 100);  // on faces, either
}

DatasetPtr test_mesh(const std::string& kind) {
  if (kind == "mixed") return block_cells("mixed", 6, 0.15).dataset();
  if (kind == "polyhedra") return block_cells("polyhedron", 6, 0.1).dataset();
  if (kind == "bent quadratic tetra") return block_cells("curved", 4, 0.1).dataset();
  if (kind == "blanked curvilinear") return curvilinear({9, 8, 7}, true);
  if (kind == "nested amr") return amr();
  return mesh_of(kind, 6, 1);
}

}  // namespace

TEST_CASE("walk: short random steps give the answers of the locator in every kind of mesh") {
  std::vector<std::string> all = kinds();
  all.insert(all.end(), {"mixed", "polyhedra", "bent quadratic tetra", "blanked curvilinear", "nested amr"});
  for (const std::string& kind : all) {
    CAPTURE(kind);
    compare(with_velocity(test_mesh(kind), wavy), 20000, 0.06, kind != "mixed");
  }
}

TEST_CASE("walk: far from zero, and with hidden cells among mixed ones") {
  // What doubles leave uncertain of places there is 1e-10 of a cell.
  const DatasetPtr far = block_cells("mixed", 5, 0.1).dataset({1e5, -2e5, 3e4});
  compare(with_velocity(far, [](Vec3 p) { return wavy(p - Vec3(1e5, -2e5, 3e4)); }), 3000, 0.06, false, 1e-8);
  DatasetParts parts = with_velocity(block_cells("mixed", 6, 0.15).dataset(), wavy)->parts();
  std::vector<uint8_t> ghost(cell_count(parts.mesh));
  for (size_t c = 0; c < ghost.size(); c += 9) ghost[c] = ghost_hidden_cell;
  parts.cell_ghost = Array::from_vector(std::move(ghost));
  compare(make_dataset(std::move(parts)), 20000, 0.06, false);
}

TEST_CASE("walk: lines cross from block to block as through one mesh") {
  // A curvilinear grid and its halves.
  const auto part = [](size_t first, size_t last) {
    CurvilinearGrid g;
    g.dims = {last - first + 1, 9, 9};
    std::vector<double> xyz;
    for (size_t k = 0; k < 9; ++k)
      for (size_t j = 0; j < 9; ++j)
        for (size_t i = first; i <= last; ++i) {
          const Vec3 q = Vec3(double(i) / 8, double(j) / 4 - 1, double(k) / 4 - 1);
          const Vec3 p = q + 0.1 * Vec3(std::sin(2 * q.y), std::sin(2 * q.z), std::cos(2 * q.x));
          xyz.insert(xyz.end(), {p.x, p.y, p.z});
        }
    g.points.xyz = Array::from_vector(std::move(xyz), 3);
    return with_velocity(make_dataset(std::move(g)), [](Vec3 p) { return Vec3(1, 0.3 * std::sin(2 * p.x), -0.2 * p.y); });
  };
  auto blocks = std::make_shared<Collection>();
  for (size_t b = 0; b < 4; ++b) blocks->parts.push_back({"block", Data(part(4 * b, 4 * b + 4))});
  Context context;
  const FlowField whole(part(0, 16), "u", context);
  const FlowParts parts(Data(CollectionPtr(blocks)), "u", "test", context);
  REQUIRE(parts.count() == 4);
  std::vector<Vec3> seeds;
  for (uint64_t n = 0; n < 50; ++n) seeds.push_back(Vec3(0.2, 0, 0) + 0.5 * Vec3(0, random_vec(n).y, random_vec(n).z));
  // Fixed steps: adaptive ones enlarge differences of the last digit at each kink between cells, along the same path.
  TraceOptions o;
  o.scheme = Scheme::rk4;
  const TracedLines a = trace_lines(whole, seeds, TraceDirection::forward, o, context);
  const TracedLines b = trace_lines(parts, seeds, TraceDirection::forward, o, context);
  REQUIRE(a.points.size() == b.points.size());
  CHECK(a.points.size() > 50 * 10);
  double worst = 0;
  for (size_t i = 0; i < a.points.size(); ++i) worst = std::max(worst, length(a.points[i] - b.points[i]));
  CHECK(worst < 1e-9);
}

TEST_CASE("walk: steps in length are as long as they should be, and time is kept") {
  // A vortex whose speed grows with the radius: arcs of the same length, angle after time t is t.
  const DatasetPtr mesh = with_velocity(mesh_of("uniform", 6, 1), [](Vec3 p) { return Vec3(-p.y - 0.2 * p.x, p.x - 0.2 * p.y, 0); });
  TraceOptions o;
  o.scheme = Scheme::rk4, o.unit = StepUnit::length, o.step = 0.01, o.min_step = 0.001, o.max_step = 0.01, o.closed = false;
  o.max_time = 3;
  const TracedLines l = line_from(mesh, {0.7, 0, 0}, o);
  REQUIRE(l.lines() == 1);
  CHECK(l.stop[0] == StopReason::time);
  CHECK(l.time.back() == doctest::Approx(3).epsilon(1e-12));
  for (size_t i = 1; i + 1 < l.points.size(); ++i) CHECK(length(l.points[i] - l.points[i - 1]) == doctest::Approx(0.01).epsilon(1e-4));
  for (size_t i = 0; i < l.points.size(); ++i) {
    const double t = l.time[i], r = 0.7 * std::exp(-0.2 * t);
    CHECK(length(l.points[i] - Vec3(r * std::cos(t), r * std::sin(t), 0)) < 1e-8);
  }
  // Towards a place where the flow stands still no step is longer than it should be.
  o.max_time = HUGE_VAL, o.step = 0.05, o.max_steps = 200, o.unit = StepUnit::cells;
  const DatasetPtr sink = with_velocity(mesh_of("uniform", 6, 1), [](Vec3 p) { return Vec3(0.1, 0.05, 0) - p; });
  const TracedLines s = line_from(sink, {0.7, 0.3, 0.2}, o);
  for (size_t i = 1; i < s.points.size(); ++i) CHECK(length(s.points[i] - s.points[i - 1]) < 0.0501 / 3);
}
