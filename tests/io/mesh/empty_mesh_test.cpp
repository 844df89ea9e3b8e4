// SPDX-License-Identifier: Apache-2.0
// Meshes without points or without cells go through every format that takes their kind with all that they have: fields of no tuples
// keep name, type, components and place.
#include "data/mesh.h"
#include "io/formats.h"
#include "io/io_files.h"
#include "support/test.h"

using namespace sg;

namespace {

Points two_points(size_t n) {
  std::vector<double> xyz{0, 0, 0, 1, 2, 3};
  xyz.resize(3 * n);
  return {Array::from_vector(std::move(xyz), 3)};
}

FieldSet some_fields(size_t points, size_t cells) {
  FieldSet f;
  f.add({"p", Association::point, Array::from_vector(std::vector<double>(points, 2.5)), "", Role::none});
  f.add({"v", Association::point, Array::from_vector(std::vector<float>(3 * points, 1.5f), 3), "", Role::vectors});
  f.add({"c", Association::cell, Array::from_vector(std::vector<double>(cells, 7)), "", Role::none});
  return f;
}

DatasetPtr read_back(const std::string& name, const DatasetPtr& d) {
  Context context;
  const std::string path = test::temp_folder() + name;
  write_data(path, d, {}, context);
  return single_dataset(read_data(path, {}, context), "test");
}

// Fields of `back` are those of `d`.
void check_fields(const Dataset& d, const Dataset& back) {
  for (const Field& f : d.fields()) {
    CAPTURE(f.name);
    const Field* g = back.fields().find(f.name, f.association);
    REQUIRE(g);
    CHECK(g->array.type() == f.array.type());
    CHECK(g->array.count() == f.array.count());
    CHECK(g->components() == f.components());
  }
}

}  // namespace

TEST_CASE("empty meshes: every format reads back what it wrote, fields of no tuples too") {
  for (const size_t n : {size_t(0), size_t(2)}) {
    CAPTURE(n);
    UnstructuredMesh u;
    u.points = two_points(n);
    SurfaceMesh s;
    s.points = two_points(n);
    const DatasetPtr solid = make_dataset(u, some_fields(n, 0)), surface = make_dataset(s, some_fields(n, 0));
    for (const char* name : {"e.vtu", "e.pvtu", "e.vtm"}) {
      CAPTURE(name);
      for (const DatasetPtr& d : {solid, surface}) {
        const DatasetPtr back = read_back(name, d);
        CHECK(back->point_count() == n);
        CHECK(back->cell_count() == 0);
        check_fields(*d, *back);
      }
    }
    for (const char* name : {"e.vtp", "e.pvtp", "e.ply", "e.obj"}) {
      CAPTURE(name);
      const DatasetPtr back = read_back(name, surface);
      CHECK(back->as<SurfaceMesh>());
      CHECK(back->point_count() == n);
      CHECK(back->cell_count() == 0);
      if (std::string_view(name) != "e.obj") check_fields(*surface, *back);
    }
    CHECK(read_back("e.stl", surface)->cell_count() == 0);
  }
}

TEST_CASE("vtk xml: pieces without points and cells add nothing, but the first tells the fields when all are so") {
  UnstructuredMesh none;
  UnstructuredMesh one;
  one.points = two_points(2);
  Context context;
  const auto collection = std::make_shared<Collection>();
  collection->parts = {
      {"a", make_dataset(none, some_fields(0, 0))}, {"b", make_dataset(one, some_fields(2, 0))}, {"c", make_dataset(none)}};
  const std::string path = test::temp_folder() + "pieces.pvtu";
  write_data(path, CollectionPtr(collection), {}, context);
  const DatasetPtr back = single_dataset(read_data(path, {}, context), "test");
  CHECK(back->point_count() == 2);
  check_fields(*std::get<DatasetPtr>(collection->parts[1].data), *back);
}

TEST_CASE("obj: a text without vertices is an empty surface only when it is nothing but comments") {
  CHECK(test::read_text("none.obj", "# nothing\n\n  # here\n")->point_count() == 0);
  CHECK(test::refusal("none.obj", "# x\nhello\n").find("no vertices") != std::string::npos);
  CHECK(test::refusal("none.obj", "# x\nvn 0 0 1\n").find("no vertices") != std::string::npos);
}

TEST_CASE("a mesh without points has an empty list of positions of three components, whoever made it") {
  CHECK(make_dataset(UnstructuredMesh{})->as<UnstructuredMesh>()->points.xyz.components() == 3);
  CHECK(make_dataset(SurfaceMesh{})->as<SurfaceMesh>()->points.xyz.components() == 3);
  CHECK(make_dataset(PointCloud{})->as<PointCloud>()->points.xyz.components() == 3);
}
