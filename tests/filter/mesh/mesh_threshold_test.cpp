// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/threshold.h"

#include <cstring>

#include "filter/mesh/faces/faces.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/to_unstructured.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::meshes;

namespace {

double volume_of(const DatasetPtr& d) {
  Context ctx;
  return measure(*faces(d, {}, ctx)->as<SurfaceMesh>()).volume;
}

}  // namespace

TEST_CASE("threshold: a slab of any mesh has the slab's volume, and the inverse has the rest") {
  Context ctx;
  const CellType types[] = {CellType::tetra,   CellType::hexahedron, CellType::voxel,         CellType::wedge,
                            CellType::pyramid, CellType::polyhedron, CellType::lagrange_tetra};
  std::vector<DatasetPtr> boxes{uniform_box(4, 4, 4)};
  for (CellType t : types) boxes.push_back(solid_box(t, 4, 2));
  for (const DatasetPtr& box : boxes) {
    CAPTURE(summary(*box));
    DatasetParts p = box->parts();
    std::vector<double> z;
    if (auto* u = box->as<UnstructuredMesh>())
      for (size_t i = 0; i < u->points.count(); ++i) z.push_back(u->points.at(i).z);
    else
      for (size_t i = 0; i < box->point_count(); ++i) z.push_back(double(i / 25) / 4);
    p.fields.add(make_field("z", Association::point, z));
    const DatasetPtr in = make_dataset(p);
    ThresholdParams t{.field = {"z"}, .min = 0.2, .max = 0.8};
    const DatasetPtr slab = threshold(in, t, ctx);
    CHECK(slab->as<UnstructuredMesh>() != nullptr);
    CHECK(volume_of(slab) == doctest::Approx(0.5));
    CHECK(linear_error(*slab, slab->as<UnstructuredMesh>()->points) < 1e-12);
    t.invert = true;
    const DatasetPtr rest = threshold(in, t, ctx);
    CHECK(rest->cell_count() + slab->cell_count() == in->cell_count());
    t.invert = false, t.all_points = false;
    // Only the pyramids that stand on the bottom or hang from the top touch no point in range.
    const bool pyramids = box->as<UnstructuredMesh>() && box->as<UnstructuredMesh>()->single_type == CellType::pyramid;
    CHECK(volume_of(threshold(in, t, ctx)) == doctest::Approx(pyramids ? 1 - 2.0 / 24 : 1));
  }
}

TEST_CASE("threshold: cell fields, components, magnitudes and unlimited sides") {
  Context ctx;
  const DatasetPtr box = uniform_box(3, 1, 1);
  DatasetParts p = box->parts();
  p.fields.add(make_field("v", Association::cell, {3, 4, 0, 0, 0, 1, -2, 0, 0}, 3));
  const DatasetPtr in = make_dataset(p);
  auto cells = [&](ThresholdParams t) {
    const DatasetPtr d = threshold(in, t, ctx);
    std::vector<double> r;
    for (size_t i = 0; i < d->cell_count(); ++i) r.push_back(d->fields().require("c").array.get(i));
    return r;
  };
  CHECK(cells({.field = {"c"}, .min = 1}) == std::vector<double>{1, 2});
  CHECK(cells({.field = {"c"}, .max = 1}) == std::vector<double>{0, 1});
  CHECK(cells({.field = {"v"}, .min = 2}) == std::vector<double>{0, 2});
  CHECK(cells({.field = {"v"}, .component = 0, .max = 0}) == std::vector<double>{1, 2});
  CHECK(cells({.min = -100}).size() == 3);
}

TEST_CASE("threshold: NaN is in no range, ghosts never stay") {
  Context ctx;
  DatasetParts p = uniform_box(4, 1, 1)->parts();
  p.fields.add(make_field("g", Association::cell, {1, NAN, 1, 1}));
  p.cell_ghost = Array::from_vector(std::vector<uint8_t>{0, 0, ghost_duplicate, ghost_hidden_cell});
  const DatasetPtr in = make_dataset(p);
  CHECK(threshold(in, {.field = {"g"}}, ctx)->cell_count() == 1);
  CHECK(threshold(in, {.field = {"g"}, .invert = true}, ctx)->cell_count() == 1);
}

TEST_CASE("threshold: surfaces and point clouds stay what they are") {
  Context ctx;
  const DatasetPtr skin = faces(solid_box(CellType::hexahedron, 2), {}, ctx);
  const DatasetPtr some = threshold(skin, {.field = {"c"}, .max = 3}, ctx);
  REQUIRE(some->as<SurfaceMesh>() != nullptr);
  CHECK(some->cell_count() == 12);
  CHECK(linear_error(*some, some->as<SurfaceMesh>()->points) < 1e-12);
  FieldSet fields;
  fields.add(make_field("f", Association::point, {1, 2, NAN}));
  const DatasetPtr cloud = make_dataset(PointCloud{{Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 2, 0, 0}, 3), {}}}, fields);
  const DatasetPtr few = threshold(cloud, {.min = 1.5}, ctx);
  REQUIRE(few->as<PointCloud>() != nullptr);
  CHECK(few->point_count() == 1);
  CHECK(few->as<PointCloud>()->points.at(0).x == 1);
}

TEST_CASE("threshold: mistakes say what would be right") {
  Context ctx;
  const DatasetPtr box = uniform_box(2, 2, 2);
  CHECK(error_of([&] { threshold(box, {.field = {"ff"}}, ctx); }).find("did you mean 'f'") != std::string::npos);
  CHECK(error_of([&] { threshold(box, {.field = {"f"}, .min = 2, .max = 1}, ctx); }).find("min 2 is above max 1") != std::string::npos);
  CHECK(error_of([&] { threshold(box, {.field = {"f"}, .component = 2}, ctx); }).find("no component 2") != std::string::npos);
  CHECK(error_of([&] { threshold(make_dataset(UniformGrid{}), {}, ctx); }).find("no scalar field") != std::string::npos);
  FieldSet whole;
  whole.add(make_field("w", Association::whole, {1}));
  CHECK(error_of([&] { threshold(make_dataset(UniformGrid{}, whole), {.field = {"w"}}, ctx); }).find("whole mesh") != std::string::npos);
  std::vector<std::string> notes;
  ctx.on_log = [&](LogLevel, std::string_view t) { notes.emplace_back(t); };
  CHECK(threshold(box, {.field = {"f"}, .min = 100}, ctx)->cell_count() == 0);
  REQUIRE(notes.size() == 1);
}

TEST_CASE("threshold: several ranges, several fields") {
  Context ctx;
  const DatasetPtr box = uniform_box(10, 3, 3);
  ThresholdParams p;
  p.field = {"c"};
  p.ranges = {0, 4, 80, 89};
  CHECK(threshold(box, p, ctx)->cell_count() == 15);
  p = {};
  p.fields = {"c", "f"};
  p.ranges = {-0.75, 5};
  CHECK(threshold(box, p, ctx)->cell_count() == 3);
  p.ranges = {5, 0};
  CHECK(error_of([&] { threshold(box, p, ctx); }).find("is empty") != std::string::npos);
  p.ranges = {5};
  CHECK(error_of([&] { threshold(box, p, ctx); }).find("pairs") != std::string::npos);
  p.ranges = {0, 1}, p.min = 2;
  CHECK(error_of([&] { threshold(box, p, ctx); }).find("together with") != std::string::npos);
}

TEST_CASE("threshold: a lattice by bits keeps the cells that a list of them keeps") {
  Context ctx;
  for (const size_t nx : {1, 5, 63, 64, 65, 130}) {
    DatasetParts parts = uniform_box(nx, 6, 5)->parts();
    std::vector<double> v((nx + 1) * 7 * 6);
    for (size_t i = 0; i < v.size(); ++i) v[i] = double(i * 2654435761u % 1000);
    parts.fields.add(make_field("g", Association::point, v));
    const DatasetPtr d = make_dataset(parts);
    for (const bool all : {true, false})
      for (const bool invert : {true, false}) {
        ThresholdParams p;
        p.field = {"g"}, p.min = all ? 100 : 800, p.all_points = all, p.invert = invert;
        const DatasetPtr a = threshold(d, p, ctx), b = threshold(to_unstructured(d), p, ctx);
        CHECK(a->cell_count() == b->cell_count());
        CHECK(a->point_count() == b->point_count());
        for (const char* name : {"g", "c"}) {
          const Array &x = a->fields().require(name).array, &y = b->fields().require(name).array;
          for (size_t i = 0; i < x.count(); ++i) REQUIRE(x.get(i) == y.get(i));
        }
        const auto &ma = *a->as<UnstructuredMesh>(), &mb = *b->as<UnstructuredMesh>();
        const CellsView va = cells_view(ma.cells), vb = cells_view(mb.cells);
        for (size_t c = 0; c < va.count; ++c)
          for (size_t k = 0; k < 8; ++k) REQUIRE(va.point(c, k) == vb.point(c, k));
        for (size_t i = 0; i < a->point_count(); ++i) REQUIRE(ma.points.at(i) == mb.points.at(i));
      }
  }
}

TEST_CASE("threshold: labels by their names") {
  Context ctx;
  std::vector<std::string> notes;
  ctx.on_log = [&](LogLevel, std::string_view t) { notes.emplace_back(t); };
  DatasetParts parts = uniform_box(10, 1, 1)->parts();
  parts.fields.add(make_field("other", Association::cell, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  parts.fields.add(make_field("material", Association::cell, {3, 3, 1, 1, 1, 7, 7, 7, 7, 2}));
  parts.notes.emplace_back("labels of material", "1=Steel\n3=air gap\n7=copper");
  const DatasetPtr bar = make_dataset(parts);
  ThresholdParams p;
  p.names = {"steel", "air gap"};
  CHECK(threshold(bar, p, ctx)->cell_count() == 5);  // the field that has names
  p.field = {"material"}, p.invert = true;
  CHECK(threshold(bar, p, ctx)->cell_count() == 5);
  p.invert = false, p.names = {"copper", "gold"};
  CHECK(threshold(bar, p, ctx)->cell_count() == 4);
  REQUIRE(notes.size() == 1);
  CHECK(notes[0] == "threshold: no label of 'material' is named 'gold'; there are Steel, air gap, copper");
  p.max = 3;
  CHECK(error_of([&] { threshold(bar, p, ctx); }).find("either names or numbers") != std::string::npos);
  p = {.field = {"other"}, .names = {"steel"}};
  CHECK(error_of([&] { threshold(bar, p, ctx); }).find("have no names") != std::string::npos);
}
