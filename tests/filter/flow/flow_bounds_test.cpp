// SPDX-License-Identifier: Apache-2.0
// Flows that no steps can follow, and cells without volume: they are refused or passed, soon.
#include "filter/flow/flow_meshes.h"
#include "filter/flow/fronts/stream_surface.h"
#include "filter/flow/lines/even_streamlines.h"
#include "filter/flow/streamlines.h"
#include "filter/flow/texture/surface/surface_lic.h"
#include "filter/flow/unsteady/pathlines.h"
#include "filter/flow/unsteady/streaklines.h"
#include "filter/flow/vortex/ftle.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::flow;

namespace {

std::string note_of(const std::function<void(Context&)>& f) {
  Context context;
  std::string notes;
  context.on_log = [&](LogLevel, std::string_view s) { notes += std::string(s) + "\n"; };
  f(context);
  return notes;
}

}  // namespace

TEST_CASE("flow: velocities that are infinite or too large to be squared are none, in f32 and f64, and a note tells") {
  const auto spoilt = [](Vec3 p, double bad) { return p.x > 0.7 ? Vec3(0, bad, 0) : rotation(p); };
  const auto check = [&](const DatasetPtr& d) {
    std::optional<FlowField> field;
    const std::string notes = note_of([&](Context& c) { field.emplace(d, "u", c); });
    CHECK(contains(notes, "infinite or beyond"));
    CHECK(field->largest_speed() < 2);
    CHECK(field->usual_speed() < 2);
    FlowCursor cursor(*field);
    Vec3 v;
    CHECK(cursor(Vec3(0.1, 0.2, 0), v));
    CHECK(length(v - rotation({0.1, 0.2, 0})) < 1e-6);
    CHECK_FALSE(cursor(Vec3(0.95, 0.2, 0), v));
  };
  for (const double bad : {HUGE_VAL, 1e200}) check(with_velocity(mesh_of("uniform", 8, 1), [&](Vec3 p) { return spoilt(p, bad); }));
  for (const double bad : {HUGE_VAL, 1e30}) check(with_velocity<float>(mesh_of("tetra", 8, 1), [&](Vec3 p) { return spoilt(p, bad); }));
  check(with_velocity<float>(
      mesh_of("uniform", 8, 1), [&](Vec3 p) { return spoilt(p, 1e20); }, 2));
  CHECK(note_of([&](Context& c) { FlowField(with_velocity(mesh_of("uniform", 8, 1), rotation), "u", c); }).empty());
}

TEST_CASE("flow: a time in which the flow passes through a billion cells is refused, and so are steps that go nowhere") {
  Context context;
  const DatasetPtr d = with_velocity(mesh_of("uniform", 4, 1), rotation);
  PathlinesParams p;
  p.seeds.points = {0.5, 0, 0};
  CHECK(contains(error_of([&] { pathlines(steady_series(d, {0, 1e15}), {}, p, context); }), "units of time"));
  FtleParams f;
  f.duration = 1e9, f.size = 8;
  CHECK(contains(error_of([&] { ftle(steady_series(d, {0}), f, context); }), "units of time"));
  f.duration = 1;
  CHECK_NOTHROW(ftle(steady_series(d, {0}), f, context));
  for (const char* unit : {"cells", "length", "time"}) {
    CAPTURE(unit);
    p.integration.step = 1e-300, p.integration.step_unit = *value_of_word<StepUnit>(unit);
    CHECK(contains(error_of([&] { pathlines(steady_series(d, {0, 1}), {}, p, context); }), "do not cross a cell"));
    p.integration.step = 1e-2;
    CHECK_NOTHROW(pathlines(steady_series(d, {0, 1}), {}, p, context));
  }
}

TEST_CASE("flow: spacings and steps without measure are refused by name") {
  Context context;
  const DatasetPtr d = with_velocity(mesh_of("uniform", 4, 1), rotation);
  StreaklinesParams s;
  s.seeds.points = {0.5, 0, 0};
  s.spacing = 1e-300;
  CHECK(contains(error_of([&] { streaklines(steady_series(d, {0, 1}), {}, s, context); }), "spacing=1e-300"));
  s.spacing = 0.1;
  CHECK_NOTHROW(streaklines(steady_series(d, {0, 1}), {}, s, context));
  SurfaceLicParams lic;
  lic.density = 8, lic.step = 1e9;
  CHECK(contains(error_of([&] { surface_lic(d, lic, context); }), "step=1e+09"));
  lic.step = 1e-300;
  CHECK(surface_lic(d, lic, context)->fields().require("lic").array.count() > 0);
  const DatasetPtr nothing = with_velocity(moved(mesh_of("tetra", 2, 1), [](Vec3) { return Vec3(1, 1, 1); }), rotation);
  CHECK(contains(error_of([&] { even_streamlines({nothing}, {}, context); }), "no finite extent"));
}

TEST_CASE("stream surface: where places are too far from the origin to move, it ends") {
  UniformGrid g = uniform({4, 4, 4}, {0, 0, 0}, {3, 3, 3});
  g.origin = {1e17, 1e17, 1e17};  // numbers there are 16 apart
  const DatasetPtr d = with_velocity(make_dataset(g), [](Vec3) { return Vec3(1, 1, 0); });
  Context context;
  StreamSurfaceParams p;
  try {
    stream_surface({d}, p, context);
  } catch (const Error& e) {
    CHECK(std::string_view(e.what()).size() > 10);
  }
}

TEST_CASE("streamlines: cells without volume among others change nothing, and a mesh of nothing else says so") {
  const DatasetPtr good = with_velocity(mesh_of("tetra", 4, 1), rotation);
  DatasetParts parts = good->parts();
  UnstructuredMesh m = *good->as<UnstructuredMesh>();
  const CellsView cells = cells_view(m.cells);
  std::vector<int64_t> all, flat;
  for (size_t c = 0; c < cells.count; ++c) {
    for (size_t k = 0; k < 4; ++k) all.push_back(cells.point(c, k));
    // A point twice, all in one point, three in a row.
    for (const auto& four : {std::array<size_t, 4>{0, 1, 2, 2}, std::array<size_t, 4>{3, 3, 3, 3}, std::array<size_t, 4>{0, 1, 0, 1}})
      for (const size_t k : four) all.push_back(cells.point(c, k)), flat.push_back(cells.point(c, k));
  }
  const auto with_cells = [&](const std::vector<int64_t>& ids) {
    UnstructuredMesh n = m;
    n.cells = {Array::from_vector(std::vector<int64_t>(ids)), {}, 4}, n.types = {}, n.single_type = CellType::tetra;
    DatasetParts p = parts;
    p.mesh = n;
    return make_dataset(std::move(p));
  };
  Context context;
  StreamlinesParams p;
  p.seeds.points = {0.5, 0, 0.1, 0.3, 0.2, -0.4}, p.stop.max_time = 3;
  p.direction = TraceDirection::forward;
  const auto a = std::get<DatasetPtr>(streamlines({good}, p, context)),
             b = std::get<DatasetPtr>(streamlines({with_cells(all)}, p, context));
  const auto end = [](const DatasetPtr& d) { return d->as<SurfaceMesh>()->points.at(d->point_count() - 1); };
  CHECK(b->cell_count() == 2);
  CHECK(length(end(a) - end(b)) < 1e-3);
  CHECK(length(end(b) - Vec3(std::hypot(0.3, 0.2) * std::cos(std::atan2(0.2, 0.3) + 3),
                             std::hypot(0.3, 0.2) * std::sin(std::atan2(0.2, 0.3) + 3), -0.4)) < 0.02);
  CHECK(error_of([&] { streamlines({with_cells(flat)}, p, context); }).size() > 10);
}
