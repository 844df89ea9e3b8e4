// SPDX-License-Identifier: Apache-2.0
// Streamlines of real flows: every mesh kind that files bring.
#include "filter/flow/streamlines.h"
#include "io/io.h"
#include "simulate/flow_fields.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

DatasetPtr lines_of(const Data& data, StreamlinesParams p = {}) {
  Context context;
  return std::get<DatasetPtr>(streamlines({data}, p, context));
}
Data file(const char* name) {
  Context context;
  return read_data(data_file(name), {}, context);
}

}  // namespace

TEST_CASE("streamlines of files: lines cross the six blocks about a cylinder and keep their mass flow" * doctest::skip(no_data())) {
  const Data data = file("vectors/cylinder_Re35/cylinder_Re35.case");
  StreamlinesParams p;
  p.direction = TraceDirection::forward, p.seeds.from = Vec3(0.05, -3, 0), p.seeds.to = Vec3(0.05, 3, 0), p.seeds.count = 13;
  const DatasetPtr lines = lines_of(data, p);
  CHECK(lines->cell_count() == 13);
  const auto& s = *lines->as<SurfaceMesh>();
  const CellsView v = cells_view(s.lines);
  // They run from the inlet to the outlet without crossing each other.
  double last = -HUGE_VAL;
  size_t through = 0;
  for (size_t l = 0; l < v.count; ++l) {
    const Vec3 end = s.points.at(v.end(l) - 1);
    if (end.x < 14.9) continue;
    ++through;
    CHECK(end.y > last);
    last = end.y;
  }
  CHECK(through >= 12);
}

TEST_CASE("streamlines of files: vessel, room, combustor and triangles give lines with the mesh's fields" * doctest::skip(no_data())) {
  for (const char* name : {"vectors/carotid.vtk", "vectors/office.binary.vtk", "vectors/SurfaceVectors.vtk", "vectors/BuiltInExample1.vti",
                           "meshes/curvilinear/comb/combxyz.bin"}) {
    CAPTURE(name);
    const Data data = file(name);
    const DatasetPtr mesh = single_dataset(data, "test");
    StreamlinesParams p;
    p.seeds.count = 30;
    const DatasetPtr lines = lines_of(data, p);
    CHECK(lines->cell_count() > 20);
    const Box3 in = mesh->bounds(), out = lines->bounds();
    for (int a = 0; a < 3; ++a) {
      CHECK(out.lo[a] >= in.lo[a] - 1e-4 * in.diagonal());
      CHECK(out.hi[a] <= in.hi[a] + 1e-4 * in.diagonal());
    }
    for (const Field& f : mesh->fields())
      if (f.association == Association::point) CHECK(lines->fields().find(f.name, Association::point));
    CHECK(lines->stats(lines->fields().require("speed")).nan == 0);
  }
}

TEST_CASE("streamlines of sources: closed lines of the double gyre") {
  Context context;
  DoubleGyreParams g;
  g.grid.size = 129;
  StreamlinesParams p;
  p.seeds.from = Vec3(0.1, 0.5, 0), p.seeds.to = Vec3(0.4, 0.5, 0), p.seeds.count = 7;
  p.direction = TraceDirection::forward, p.integration.tolerance = 1e-6;
  p.stop.max_time = 400;
  const DatasetPtr lines = lines_of(double_gyre(g, context), p);
  for (size_t l = 0; l < 7; ++l) CHECK(StopReason(int(lines->fields().require("stop").array.get(l))) == StopReason::closed);
}
