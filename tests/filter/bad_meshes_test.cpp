// SPDX-License-Identifier: Apache-2.0
// What makes and cuts surfaces, on meshes that are empty, of one cell, or broken.
#include "filter/cell_meshes.h"
#include "filter/mesh/clip/clip.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/select/extract.h"
#include "filter/mesh/select/threshold.h"
#include "filter/mesh/slice/slice.h"
#include "filter/scalar/bands.h"
#include "filter/scalar/isolines.h"

using namespace sg;
using namespace sg::test;

namespace {

using Operation = DatasetPtr (*)(const DatasetPtr&, Context&);

DatasetPtr contour_of(const DatasetPtr& d, std::vector<double> values, Context& c) {
  ContourParams p;
  p.values = std::move(values);
  return contour(d, p, c);
}
DatasetPtr lines_of(const DatasetPtr& d, std::vector<double> values, Context& c) {
  IsolinesParams p;
  p.values = std::move(values);
  return isolines(d, p, c);
}
DatasetPtr bands_of(const DatasetPtr& d, std::vector<double> values, Context& c) {
  BandsParams p;
  p.values = std::move(values);
  return bands(d, p, c);
}
template <class P>
P oblique() {
  P p;
  p.origin = Vec3(0.3, 0.3, 0.3), p.normal = {1, 2, 3};
  return p;
}

const std::pair<const char*, Operation> operations[] = {
    {"contour", [](const DatasetPtr& d, Context& c) { return contour_of(d, {0.3}, c); }},
    {"slice", [](const DatasetPtr& d, Context& c) { return slice(d, oblique<SliceParams>(), c); }},
    {"clip", [](const DatasetPtr& d, Context& c) { return std::get<DatasetPtr>(clip(d, oblique<ClipParams>(), c)); }},
    {"clip by value",
     [](const DatasetPtr& d, Context& c) {
       ClipParams p;
       p.value = 0.3;
       return std::get<DatasetPtr>(clip(d, p, c));
     }},
    {"isovolume",
     [](const DatasetPtr& d, Context& c) {
       IsovolumeParams p;
       p.min = 0.1, p.max = 0.6;
       return isovolume(d, p, c);
     }},
    {"threshold",
     [](const DatasetPtr& d, Context& c) {
       ThresholdParams p;
       p.min = 0.3, p.all_points = false;
       return threshold(d, p, c);
     }},
    {"faces", [](const DatasetPtr& d, Context& c) { return faces(d, {}, c); }},
    {"bands",
     [](const DatasetPtr& d, Context& c) {
       return bands_of(d, {0.1, 0.3}, c);
     }},
    {"isolines", [](const DatasetPtr& d, Context& c) { return lines_of(d, {0.3}, c); }},
};

FieldSet scalars(std::vector<double> v) {
  FieldSet f;
  f.add({"f", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  return f;
}

// A mesh of the corners of the unit cube.
DatasetPtr of_cube(const CellsOf& m, std::vector<double> v) {
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(m.xyz, 3);
  mesh.cells.connectivity = Array::from_vector(m.ids);
  mesh.cells.offsets = Array::from_vector(m.offsets);
  mesh.types = Array::from_vector(m.types);
  if (!m.faces.empty()) {
    std::vector<int64_t> ids, offsets{0};
    for (const auto& face : m.faces) {
      ids.insert(ids.end(), face.begin(), face.end());
      offsets.push_back(int64_t(ids.size()));
    }
    mesh.faces.connectivity = Array::from_vector(ids);
    mesh.faces.offsets = Array::from_vector(offsets);
    mesh.polyhedron_faces = Array::from_vector(m.of_cell);
  }
  return make_dataset(mesh, scalars(std::move(v)));
}

CellsOf corners() {
  CellsOf m;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) m.point(Vec3(i, j, k));
  return m;
}

bool finite(const DatasetPtr& d) {
  const Box3 b = d->bounds();
  return b.empty() || (std::isfinite(dot(b.lo, b.lo)) && std::isfinite(dot(b.hi, b.hi)));
}

}  // namespace

TEST_CASE("empty meshes of every kind give empty results with their field") {
  UnstructuredMesh cells;
  cells.points.xyz = Array::from_vector(std::vector<float>{}, 3);
  cells.cells = {Array::from_vector(std::vector<int32_t>{}), Array::from_vector(std::vector<int32_t>{0}), 0};
  cells.types = Array::from_vector(std::vector<uint8_t>{});
  SurfaceMesh surface;
  surface.points = cells.points, surface.polygons = cells.cells;
  for (const DatasetPtr& d : {make_dataset(cells, scalars({})), make_dataset(surface, scalars({}))})
    for (const auto& [name, operation] : operations) {
      CAPTURE(d->kind());
      CAPTURE(name);
      Context context;
      const DatasetPtr r = operation(d, context);
      CHECK(r->cell_count() == 0);
      CHECK(r->point_count() == 0);
      CHECK(r->fields().find("f", Association::point));
    }
}

TEST_CASE("one cell of every linear kind can be contoured, cut, kept and drawn") {
  for (const CellType type :
       {CellType::tetra, CellType::hexahedron, CellType::voxel, CellType::wedge, CellType::pyramid, CellType::polyhedron}) {
    CellsOf m = corners();
    if (type == CellType::tetra) m.cell(type, {0, 1, 2, 4});
    if (type == CellType::hexahedron) m.cell(type, {0, 1, 3, 2, 4, 5, 7, 6});
    if (type == CellType::voxel) m.cell(type, {0, 1, 2, 3, 4, 5, 6, 7});
    if (type == CellType::wedge) m.cell(type, {0, 1, 2, 4, 5, 6});
    if (type == CellType::pyramid) m.cell(type, {0, 1, 3, 2, 4});
    if (type == CellType::polyhedron) m.polyhedron({0, 1, 2, 4}, {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}});
    const DatasetPtr d = of_cube(m, {1, 0, 0, 0, 0, 0, 0, 0});
    for (const auto& [name, operation] : operations) {
      CAPTURE(int(type));
      CAPTURE(name);
      Context context;
      const DatasetPtr r = operation(d, context);
      CHECK(r->cell_count() > 0);
      CHECK(finite(r));
    }
  }
}

TEST_CASE("collapsed, flat, open and self-crossing cells harm neither contours nor cuts, with any values") {
  CellsOf m = corners();
  m.cell(CellType::hexahedron, {0, 0, 0, 0, 4, 5, 7, 6});
  m.cell(CellType::hexahedron, {3, 3, 3, 3, 3, 3, 3, 3});
  m.cell(CellType::tetra, {0, 1, 2, 3});
  m.cell(CellType::wedge, {0, 1, 2, 0, 1, 2});
  m.cell(CellType::pyramid, {0, 3, 1, 2, 4});  // its base crosses itself
  m.polyhedron({0, 1, 2, 3, 4, 5, 6, 7}, {{0, 3, 1, 2}, {4, 7, 5, 6}, {0, 1, 5, 4}});
  m.polyhedron({0, 1, 3, 2, 4, 5, 7, 6}, {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 4, 5}, {3, 7, 2, 6}, {0, 4, 7, 3}, {1, 2, 5, 6}});
  m.polyhedron({0, 7}, {{0, 1}, {1, 0}});
  for (int pattern = 0; pattern < 256; pattern += 3) {
    std::vector<double> v;
    for (int c = 0; c < 8; ++c) v.push_back(pattern % 7 == 5 && c == 6 ? double(NAN) : pattern >> c & 1 ? c == 5 ? HUGE_VAL : 1.5 : -1);
    const DatasetPtr d = of_cube(m, v);
    for (const auto& [name, operation] : operations) {
      CAPTURE(name);
      CAPTURE(pattern);
      Context context;
      CHECK(finite(operation(d, context)));
    }
  }
}

TEST_CASE("lines of a vector ask which component is meant; bands and clips take its magnitude") {
  const DatasetPtr box = meshes::uniform_box(3, 3, 0);
  DatasetParts parts = box->parts();
  std::vector<double> u;
  for (size_t i = 0; i < box->point_count(); ++i) u.insert(u.end(), {0, double(i % 4), 0});
  parts.fields.add({"u", Association::point, Array::from_vector(std::move(u), 3), "", Role::vectors});
  const DatasetPtr d = make_dataset(parts);
  Context context;
  IsolinesParams lines;
  lines.field = {"u"}, lines.values = {1.5};
  CHECK(error_of([&] { isolines(d, lines, context); }).find("magnitude") != std::string::npos);
  lines.component = "y";
  CHECK(isolines(d, lines, context)->cell_count() == 1);
  BandsParams b;
  b.field = {"u"}, b.values = {1.5};
  const DatasetPtr banded = bands(d, b, context);
  CHECK(banded->range(banded->fields().require("band"), 0).hi == 1);
  ClipParams p;
  p.field = {"u"}, p.value = 1.5;
  const Box3 kept = std::get<DatasetPtr>(clip(d, p, context))->bounds();
  CHECK(kept.lo.x == doctest::Approx(0.5));
  CHECK(kept.hi.x == doctest::Approx(1));
}

TEST_CASE("values may come in any order: lines and bands do not change, surfaces come in the order asked for") {
  const DatasetPtr d = meshes::uniform_box(4, 4, 0), solid = meshes::solid_box(CellType::tetra, 2);
  Context context;
  const auto lines = [&](std::vector<double> v) { return lines_of(d, std::move(v), context)->cell_count(); };
  CHECK(lines({0.5, -0.25, 1}) == lines({-0.25, 0.5, 1}));
  const auto border = [&](std::vector<double> v) { return bands_of(d, std::move(v), context); };
  CHECK(same_bytes(border({1, -0.5, 0.5})->fields().require("band").array, border({-0.5, 0.5, 1})->fields().require("band").array));
  const auto at = [&](const DatasetPtr& in, std::vector<double> v) { return contour_of(in, std::move(v), context); };
  for (const DatasetPtr& in : {solid, meshes::uniform_box(4, 4, 4)}) {
    const DatasetPtr up = at(in, {0.5, 2.5}), down = at(in, {2.5, 0.5});
    CHECK(up->cell_count() == down->cell_count());
    CHECK(up->fields().require("contour value").array.get(0) == 0.5);
    CHECK(down->fields().require("contour value").array.get(0) == 2.5);
    CHECK(Surface(up).area() == doctest::Approx(Surface(down).area()).epsilon(1e-12));
  }
}
