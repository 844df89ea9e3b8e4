// SPDX-License-Identifier: Apache-2.0
// Packets of particles against the plain tracer, target by target and for any number of threads.
#include <hwy/targets.h>

#include "base/parallel.h"
#include "base/random.h"
#include "data/cells/cell_neighbors.h"
#include "filter/flow/cursors/tet_neighbors.h"
#include "filter/flow/flow_meshes.h"
#include "filter/flow/packets/packet_lines.h"
#include "filter/flow/streamlines.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::flow;

namespace {

// A flow with swirl and stretch; smooth, so that lines near each other stay so.
Vec3 swirl(Vec3 p) {
  return {std::sin(2 * p.z) + 0.5 * std::cos(1.5 * p.y), 0.8 * std::sin(1.5 * p.x) + std::cos(2 * p.z), 0.6 * std::sin(1.5 * p.y) + 0.4};
}

std::vector<Vec3> some_seeds(size_t n, double r) {
  std::vector<Vec3> s;
  for (size_t i = 0; i < n; ++i)
    s.push_back({r * (2 * random_unit(3, 3 * i) - 1), r * (2 * random_unit(3, 3 * i + 1) - 1), r * (2 * random_unit(3, 3 * i + 2) - 1)});
  return s;
}

DatasetPtr f32_mesh(const std::string& kind) {
  DatasetPtr mesh = kind == "rotated" ? mesh_of(kind, 20, 1) : kind == "tetra" ? mesh_of("bent tetra", 8, 1) : mesh_of(kind, 24, 1);
  if (const auto* u = mesh->as<UnstructuredMesh>()) {
    UnstructuredMesh m = *u;
    m.points.xyz = m.points.xyz.converted(ElementType::f32);
    m.types = {};
    m.single_type = CellType::tetra;
    mesh = make_dataset(std::move(m));
  }
  return with_velocity<float>(mesh, swirl);
}

TraceOptions options_of(Scheme scheme, double tolerance = 1e-6) {
  TraceOptions o;
  o.scheme = scheme, o.tolerance = tolerance, o.max_steps = 400, o.max_length = 6, o.closed = false;
  if (scheme == Scheme::dormand_prince) o.max_time = 0.6;
  return o;
}

// The packets' lines against those of trace_lines(): the same steps, places within `epsilon`.
void compare(const DatasetPtr& mesh, const TraceOptions& o, TraceDirection direction, double epsilon) {
  Context context;
  const FlowField field(mesh, "u", context);
  const auto seeds = some_seeds(203, 1.1);
  const auto fast = packets::trace(field, seeds, direction, o, context);
  REQUIRE(fast);
  const TracedLines plain = trace_lines(field, seeds, direction, o, context);
  std::vector<int64_t> line_of(seeds.size(), -1);
  for (size_t l = 0; l < plain.lines(); ++l) line_of[size_t(plain.seed[l])] = int64_t(l);
  size_t compared = 0, other_length = 0;
  double worst = 0, worst_time = 0, worst_v = 0;
  for (size_t s = 0; s < seeds.size(); ++s) {
    const packets::Piece &b = fast->backward[s], &f = fast->forward[s];
    const size_t n = b.count + f.count - (b.count > 0 && f.count > 0);
    CHECK((n > 0) == (line_of[s] >= 0));
    if (n == 0 || line_of[s] < 0) continue;
    const size_t first = plain.begin[size_t(line_of[s])], m = plain.begin[size_t(line_of[s]) + 1] - first;
    // Steps that adapt go apart with the last digits of their errors: the same path, at other places. Where both end in time:
    if (o.scheme == Scheme::dormand_prince) {
      if (f.count == 0 || f.stop != StopReason::time || plain.stop[size_t(line_of[s])] != StopReason::time) continue;
      const packets::Record& r = f.first[f.count - 1];
      const Vec3 x = fast->origin + Vec3(double(r.x[0]), double(r.x[1]), double(r.x[2]));
      worst = std::max(worst, length(x - plain.points[first + m - 1]));
      ++compared;
      continue;
    }
    // Rounding may give one halving more or less at a border.
    if (n != m || (f.count ? f.stop : b.stop) != plain.stop[size_t(line_of[s])]) {
      ++other_length;
      continue;
    }
    ++compared;
    for (size_t i = 0; i < n; ++i) {
      const packets::Record& r = i < b.count ? b.first[b.count - 1 - i] : f.first[i - b.count + (b.count > 0)];
      const Vec3 x = fast->origin + Vec3(double(r.x[0]), double(r.x[1]), double(r.x[2]));
      worst = std::max(worst, length(x - plain.points[first + i]));
      worst_time = std::max(worst_time, std::abs(double(r.time) - plain.time[first + i]));
      worst_v = std::max(worst_v, length(Vec3(double(r.v[0]), double(r.v[1]), double(r.v[2])) - plain.velocity[first + i]));
    }
  }
  CHECK(compared > (o.scheme == Scheme::dormand_prince ? 20 : 100));
  CHECK(other_length * 20 <= compared);
  CHECK(worst < epsilon);
  CHECK(worst_time < 10 * epsilon);
  CHECK(worst_v < 10 * epsilon);
}

bool same(const Dataset& a, const Dataset& b) {
  const auto equal = [](const Array& x, const Array& y) {
    return x.count() == y.count() && x.type() == y.type() && std::memcmp(x.raw(), y.raw(), x.bytes()) == 0;
  };
  bool all = a.fields().size() == b.fields().size() && equal(a.as<SurfaceMesh>()->points.xyz, b.as<SurfaceMesh>()->points.xyz) &&
             equal(a.as<SurfaceMesh>()->lines.offsets, b.as<SurfaceMesh>()->lines.offsets);
  for (size_t i = 0; all && i < a.fields().size(); ++i) all = equal(a.fields()[i].array, b.fields()[i].array);
  return all;
}

DatasetPtr streamlines_of(const DatasetPtr& mesh, const std::string& integrator) {
  Context context;
  StreamlinesParams p;
  p.integration.integrator = *value_of_word<Scheme>(integrator);
  p.seeds.seeds = SeedKind::random, p.seeds.count = 300;
  p.stop.max_steps = 300;
  p.attributes = {LineAttribute::fields, LineAttribute::vorticity, LineAttribute::rotation};
  return std::get<DatasetPtr>(streamlines({Data(mesh)}, p, context));
}

}  // namespace

TEST_CASE("packets: the lines of the plain tracer to 1e-5, in grids and tetrahedra") {
  for (const char* kind : {"uniform", "rotated", "tetra"})
    for (const Scheme s : {Scheme::rk4, Scheme::midpoint, Scheme::dormand_prince})
      for (const TraceDirection d : {TraceDirection::forward, TraceDirection::backward, TraceDirection::both}) {
        if (s == Scheme::dormand_prince && d == TraceDirection::backward) continue;
        CAPTURE(kind);
        CAPTURE(int(s));
        CAPTURE(int(d));
        // Adaptive steps enlarge differences of the last digit at each kink between cells: 3.3e-5 at most.
        compare(f32_mesh(kind), options_of(s), d, s == Scheme::dormand_prince ? 5e-5 : 1e-5);
      }
}

TEST_CASE("packets: steps in length and time, limits of time and steps, and speed as the plain tracer takes them") {
  const DatasetPtr mesh = f32_mesh("uniform");
  TraceOptions o = options_of(Scheme::rk4);
  o.unit = StepUnit::length, o.step = 0.05, o.min_step = 0.005, o.max_step = 0.2;
  compare(mesh, o, TraceDirection::forward, 1e-5);
  o.unit = StepUnit::time, o.max_time = 0.73;
  compare(mesh, o, TraceDirection::both, 1e-5);
  o.max_steps = 7, o.max_time = HUGE_VAL;
  compare(mesh, o, TraceDirection::both, 1e-5);
  o = options_of(Scheme::rk4);
  o.min_speed = 0.9;
  compare(mesh, o, TraceDirection::forward, 1e-5);
}

TEST_CASE("packets: a rotation closes in grids and tetrahedra") {
  for (const char* kind : {"uniform", "tetra"}) {
    const DatasetPtr mesh = with_velocity<float>(f32_mesh(kind), [](Vec3 p) { return Vec3(-p.y, p.x, 0); });
    Context context;
    const FlowField field(mesh, "u", context);
    const Vec3 seeds[] = {{0.5, 0.1, 0.2}, {0, -0.4, 0.3}, {0.3, 0.3, -0.5}};
    for (const Scheme s : {Scheme::rk4, Scheme::dormand_prince}) {
      TraceOptions o = options_of(s);
      o.closed = true, o.step = 0.25, o.max_length = HUGE_VAL, o.max_time = HUGE_VAL;
      const auto lines = packets::trace(field, seeds, TraceDirection::both, o, context);
      REQUIRE(lines);
      for (size_t i = 0; i < 3; ++i) {
        CHECK(lines->backward[i].stop == StopReason::closed);
        CHECK(lines->forward[i].count == 0);
        CHECK(double(lines->backward[i].first[lines->backward[i].count - 1].time) == doctest::Approx(-2 * 3.14159265).epsilon(1e-4));
      }
    }
  }
}

TEST_CASE("packets: tetrahedra far from zero are followed as well as those about it") {
  DatasetPtr mesh = f32_mesh("tetra");
  DatasetParts parts = mesh->parts();
  std::get<UnstructuredMesh>(parts.mesh).points.origin = {1e6, -2e6, 3e6};
  const DatasetPtr far = make_dataset(std::move(parts));
  Context context;
  StreamlinesParams p;
  p.seeds.points = {0.1, 0.2, 0.3, -0.4, 0.1, 0.2};
  const auto near_lines = std::get<DatasetPtr>(streamlines({Data(mesh)}, p, context));
  for (size_t i = 0; i < 6; ++i) p.seeds.points[i] += i % 3 == 0 ? 1e6 : i % 3 == 1 ? -2e6 : 3e6;
  const auto far_lines = std::get<DatasetPtr>(streamlines({Data(far)}, p, context));
  REQUIRE(near_lines->point_count() == far_lines->point_count());
  const Points &a = near_lines->as<SurfaceMesh>()->points, &b = far_lines->as<SurfaceMesh>()->points;
  for (size_t i = 0; i < a.count(); ++i) CHECK(length(b.at(i) - Vec3(1e6, -2e6, 3e6) - a.at(i)) < 1e-5);
}

TEST_CASE("packets: the same bytes on every target and for any number of threads") {
  for (const char* kind : {"uniform", "tetra"}) {
    const DatasetPtr mesh = f32_mesh(kind);
    for (const char* integrator : {"rk4", "dormand_prince"}) {
      set_thread_count(1);
      const DatasetPtr want = streamlines_of(mesh, integrator);
      CHECK(want->point_count() > 4000);
      set_thread_count(8);
      CHECK(same(*want, *streamlines_of(mesh, integrator)));
      set_thread_count(0);
      for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(target);
        CAPTURE(hwy::TargetName(target));
        CHECK(same(*want, *streamlines_of(mesh, integrator)));
      }
      hwy::SetSupportedTargetsForTest(0);
      hwy::GetChosenTarget().DeInit();
    }
  }
}

TEST_CASE("tet neighbours: the same as those of the general way, for any number of threads") {
  const DatasetPtr mesh = mesh_of("tetra", 14, 1);  // ten thousand points are more than one range
  Context context;
  const CellsView cells = cells_view(mesh->as<UnstructuredMesh>()->cells);
  const auto fast = tet_neighbors(cells, 20000, context);
  const CellNeighbors slow = cell_neighbors(mesh->mesh());
  const size_t face_of[4] = {1, 2, 0, 3};
  size_t wrong = 0;
  for (size_t c = 0; c < cells.count; ++c)
    for (size_t k = 0; k < 4; ++k) wrong += fast[4 * c + k] != slow(c, face_of[k]);
  CHECK(wrong == 0);
  set_thread_count(7);
  CHECK(fast == tet_neighbors(cells, 20000, context));
  set_thread_count(0);
}
