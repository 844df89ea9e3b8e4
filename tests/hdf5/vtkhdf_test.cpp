// SPDX-License-Identifier: Apache-2.0
#include "samples.h"

using namespace sg;
using test::contains;
using test::H5Sample;

namespace {

DatasetPtr read_one(const std::string& path, const ReadOptions& options = {}) {
  return std::get<DatasetPtr>(test::read_any(path, options));
}

std::vector<double> values(const Field& f) {
  std::vector<double> v;
  for (size_t i = 0; i < f.array.count(); ++i)
    for (int c = 0; c < f.components(); ++c) v.push_back(f.array.get(i, c));
  return v;
}

// 4 x 3 x 2 points whose value is 100 x + 10 y + z, cells whose value is their number.
void make_image(H5Sample& h, const test::H5Layout& layout = {}) {
  h.vtkhdf("/VTKHDF", "ImageData");
  h.numbers<int64_t>("/VTKHDF", "WholeExtent", {2, 5, 0, 2, 0, 1});
  h.numbers<double>("/VTKHDF", "Origin", {1, 2, 3});
  h.numbers<double>("/VTKHDF", "Spacing", {0.5, 1, 2});
  h.numbers<double>("/VTKHDF", "Direction", {0, -1, 0, 1, 0, 0, 0, 0, 1});
  h.group("/VTKHDF/PointData");
  h.group("/VTKHDF/CellData");
  std::vector<float> p;
  std::vector<double> v;
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 4; ++x) p.push_back(float(100 * x + 10 * y + z)), v.insert(v.end(), {double(x), double(y), double(z)});
  h.data("/VTKHDF/PointData/p", p, {2, 3, 4}, layout);
  h.data("/VTKHDF/PointData/v", v, {2, 3, 4, 3});
  h.data("/VTKHDF/CellData/c", std::vector<int>{0, 1, 2, 3, 4, 5}, {1, 2, 3});
  h.text("/VTKHDF/PointData", "Scalars", "p");
}

// Partitions: a tetrahedron of 4 points, then two triangles of 4 points.
void make_cells(H5Sample& h) {
  h.vtkhdf("/VTKHDF", "UnstructuredGrid", true);
  h.data<int64_t>("/VTKHDF/NumberOfPoints", {4, 4});
  h.data<int64_t>("/VTKHDF/NumberOfCells", {1, 2});
  h.data<int64_t>("/VTKHDF/NumberOfConnectivityIds", {4, 6});
  h.data<double>("/VTKHDF/Points", {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 5, 0, 0, 6, 0, 0, 6, 1, 0, 5, 1, 0}, {8, 3});
  h.data<int64_t>("/VTKHDF/Connectivity", {0, 1, 2, 3, 0, 1, 2, 0, 2, 3});
  h.data<int64_t>("/VTKHDF/Offsets", {0, 4, 0, 3, 6});
  h.data<uint8_t>("/VTKHDF/Types", {10, 5, 5});
  h.group("/VTKHDF/PointData");
  h.group("/VTKHDF/CellData");
  h.data<double>("/VTKHDF/PointData/p", {0, 1, 2, 3, 4, 5, 6, 7}, {}, {{3}, true, true, true});
  h.data<int>("/VTKHDF/CellData/c", {7, 8, 9});
}

}  // namespace

TEST_CASE("vtkhdf: an image has the place, direction and numbers that the file says") {
  H5Sample h("image.vtkhdf");
  make_image(h);
  h.close();
  const DatasetPtr d = read_one(h.path);
  const auto* g = d->as<UniformGrid>();
  REQUIRE(g);
  CHECK(g->dims == std::array<size_t, 3>{4, 3, 2});
  CHECK(g->extent_start[0] == 2);
  // Point 0 lies two steps along the first axis, which points along y.
  CHECK(g->origin.x == 1);
  CHECK(g->origin.y == 3);
  CHECK(d->fields().require("p").array.get(5) == 110);
  CHECK(d->fields().require("p").role == Role::scalars);
  CHECK(d->fields().require("v").components() == 3);
  CHECK(d->fields().require("c").array.get(5) == 5);
}

TEST_CASE("vtkhdf: a region of an image is the same part as one cut afterwards, chunked or not") {
  ReadOptions part;
  part.region.lo = {1, 0, 1}, part.region.hi = {3, 2, 1}, part.region.stride = {2, 1, 1};
  for (const bool chunked : {false, true}) {
    CAPTURE(chunked);
    H5Sample h("region.vtkhdf");
    make_image(h, chunked ? test::H5Layout{{1, 2, 3}, true, true, false} : test::H5Layout{});
    h.close();
    const DatasetPtr d = read_one(h.path, part);
    CHECK(d->as<UniformGrid>()->dims == std::array<size_t, 3>{2, 3, 1});
    CHECK(values(d->fields().require("p")) == std::vector<double>{101, 301, 111, 311, 121, 321});
    CHECK(!d->fields().find("c"));  // cells do not survive a stride
  }
  part.region.stride = {1, 1, 1};
  H5Sample h("region2.vtkhdf");
  make_image(h);
  h.close();
  CHECK(values(read_one(h.path, part)->fields().require("c")) == std::vector<double>{1, 2, 4, 5});
}

TEST_CASE("vtkhdf: images of a series have the step as their first dimension, static arrays have not") {
  H5Sample h("image_steps.vtkhdf");
  h.vtkhdf("/VTKHDF", "ImageData");
  h.numbers<int64_t>("/VTKHDF", "WholeExtent", {0, 1, 0, 2, 0, 0});
  h.group("/VTKHDF/PointData"), h.group("/VTKHDF/Steps"), h.group("/VTKHDF/Steps/PointDataOffsets");
  h.numbers<int64_t>("/VTKHDF/Steps", "NSteps", {2});
  h.data<double>("/VTKHDF/Steps/Values", {0, 10});
  h.data<int>("/VTKHDF/PointData/p", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, {2, 1, 3, 2});
  h.data<int>("/VTKHDF/PointData/q", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, {2, 1, 3, 2});
  h.data<int64_t>("/VTKHDF/Steps/PointDataOffsets/q", {0, 0});
  h.data<int>("/VTKHDF/PointData/s", {5, 5, 5, 5, 5, 4}, {1, 3, 2});
  h.close();
  ReadOptions late;
  late.time = 8;
  late.region.lo = {1, 1, 0};
  const DatasetPtr d = read_one(h.path, late);
  CHECK(values(d->fields().require("p")) == std::vector<double>{9, 11});
  CHECK(values(d->fields().require("q")) == std::vector<double>{3, 5});
  CHECK(values(d->fields().require("s")) == std::vector<double>{5, 4});
}

TEST_CASE("vtkhdf: partitions become one mesh with shifted ids") {
  H5Sample h("cells.vtkhdf");
  make_cells(h);
  h.close();
  const DatasetPtr d = read_one(h.path);
  CHECK(d->point_count() == 8);
  const auto* m = d->as<UnstructuredMesh>();
  REQUIRE(m);
  const CellsView v = cells_view(m->cells);
  CHECK(v.count == 3);
  CHECK(m->type(0) == CellType::tetra);
  CHECK(m->type(2) == CellType::triangle);
  CHECK(v.point(1, 0) == 4);
  CHECK(v.point(2, 2) == 7);
  CHECK(values(d->fields().require("p")) == std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7});
  CHECK(values(d->fields().require("c")) == std::vector<double>{7, 8, 9});
  ReadOptions one;
  one.fields = {"c"};
  CHECK(read_one(h.path, one)->fields().size() == 1);
}

TEST_CASE("vtkhdf: an id of the next partition is refused") {
  H5Sample h("leak.vtkhdf");
  make_cells(h);
  H5Ldelete(h.id(), "/VTKHDF/Connectivity", H5P_DEFAULT);
  h.data<int64_t>("/VTKHDF/Connectivity", {0, 1, 2, 4, 0, 1, 2, 0, 2, 3});
  h.close();
  CHECK(contains(test::error_of([&] { read_one(h.path); }), "partition 0: point id 4 is not in 0..3"));
}

TEST_CASE("vtkhdf: a step is found through the tables of offsets") {
  H5Sample h("steps.vtkhdf");
  h.vtkhdf("/VTKHDF", "UnstructuredGrid");
  // Step 0: one part with a line; step 1: two parts, a line each; points move.
  h.data<int64_t>("/VTKHDF/NumberOfPoints", {2, 2, 2});
  h.data<int64_t>("/VTKHDF/NumberOfCells", {1, 1, 1});
  h.data<int64_t>("/VTKHDF/NumberOfConnectivityIds", {2, 2, 2});
  h.data<double>("/VTKHDF/Points", {0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 1, 2, 0, 1, 3, 0, 1}, {6, 3});
  h.data<int64_t>("/VTKHDF/Connectivity", {0, 1, 1, 0, 0, 1});
  h.data<int64_t>("/VTKHDF/Offsets", {0, 2, 0, 2, 0, 2});
  h.data<uint8_t>("/VTKHDF/Types", {3, 3, 3});
  h.group("/VTKHDF/PointData"), h.group("/VTKHDF/CellData"), h.group("/VTKHDF/FieldData"), h.group("/VTKHDF/Steps");
  h.group("/VTKHDF/Steps/PointDataOffsets"), h.group("/VTKHDF/Steps/FieldDataOffsets");
  h.numbers<int64_t>("/VTKHDF/Steps", "NSteps", {2});
  h.data<double>("/VTKHDF/Steps/Values", {0.5, 1.5});
  h.data<int64_t>("/VTKHDF/Steps/NumberOfParts", {1, 2});
  h.data<int64_t>("/VTKHDF/Steps/PartOffsets", {0, 1});
  h.data<int64_t>("/VTKHDF/Steps/PointOffsets", {0, 2});
  h.data<int64_t>("/VTKHDF/Steps/CellOffsets", {0, 1}, {2, 1});
  h.data<int64_t>("/VTKHDF/Steps/ConnectivityIdOffsets", {0, 2}, {2, 1});
  h.data<float>("/VTKHDF/PointData/p", {10, 11, 20, 21, 22, 23});
  h.data<int64_t>("/VTKHDF/Steps/PointDataOffsets/p", {0, 2});
  h.data<int>("/VTKHDF/CellData/c", {1, 2, 3});  // no table: lies as the cells do
  h.data<double>("/VTKHDF/FieldData/f", {7, 8});
  h.data<int64_t>("/VTKHDF/Steps/FieldDataOffsets/f", {0, 1});
  h.close();
  Context context;
  CHECK(file_times(h.path, {}, context) == std::vector<double>{0.5, 1.5});
  const DatasetPtr first = read_one(h.path);
  CHECK(first->time() == 0.5);
  CHECK(first->point_count() == 2);
  ReadOptions late;
  late.time = 1.4;
  const DatasetPtr d = read_one(h.path, late);
  CHECK(d->time() == 1.5);
  CHECK(d->point_count() == 4);
  CHECK(cells_view(d->as<UnstructuredMesh>()->cells).point(0, 0) == 1);
  CHECK(cells_view(d->as<UnstructuredMesh>()->cells).point(1, 1) == 3);
  CHECK(values(d->fields().require("p")) == std::vector<double>{20, 21, 22, 23});
  CHECK(values(d->fields().require("c")) == std::vector<double>{2, 3});
  CHECK(values(d->fields().require("f")) == std::vector<double>{8});
  late.time.reset(), late.step = 2;
  CHECK(contains(test::error_of([&] { read_one(h.path, late); }), "there is no time step 2"));
}

TEST_CASE("vtkhdf: surfaces of several partitions keep cell fields with their cells") {
  H5Sample h("surface.vtkhdf");
  h.vtkhdf("/VTKHDF", "PolyData");
  h.data<int64_t>("/VTKHDF/NumberOfPoints", {3, 3});
  h.data<float>("/VTKHDF/Points", {0, 0, 0, 1, 0, 0, 0, 1, 0, 4, 0, 0, 5, 0, 0, 4, 1, 0}, {6, 3});
  const auto list = [&](const std::string& kind, std::vector<int64_t> cells, std::vector<int64_t> ids, std::vector<int64_t> offsets,
                        std::vector<int64_t> connectivity) {
    const std::string at = "/VTKHDF/" + kind;
    h.group(at);
    h.data(at + "/NumberOfCells", cells), h.data(at + "/NumberOfConnectivityIds", ids);
    h.data(at + "/Offsets", offsets), h.data(at + "/Connectivity", connectivity);
  };
  list("Vertices", {0, 1}, {0, 1}, {0, 0, 1}, {2});
  list("Lines", {1, 0}, {2, 0}, {0, 2, 0}, {0, 1});
  list("Polygons", {1, 1}, {3, 3}, {0, 3, 0, 3}, {0, 1, 2, 0, 1, 2});
  list("Strips", {0, 0}, {0, 0}, {0, 0}, {});
  h.group("/VTKHDF/CellData");
  h.data<int>("/VTKHDF/CellData/c", {1, 2, 3, 4});  // line and polygon of part 0, vertex and polygon of part 1
  h.close();
  const DatasetPtr d = read_one(h.path);
  const auto* m = d->as<SurfaceMesh>();
  REQUIRE(m);
  CHECK(m->cell_count() == 4);
  CHECK(cells_view(m->vertices).point(0, 0) == 5);
  CHECK(cells_view(m->polygons).point(1, 2) == 5);
  CHECK(values(d->fields().require("c")) == std::vector<double>{3, 1, 2, 4});
}

TEST_CASE("vtkhdf: AMR boxes become patches; cells under finer ones are marked") {
  H5Sample h("amr.vtkhdf");
  h.vtkhdf("/VTKHDF", "OverlappingAMR");
  h.numbers<double>("/VTKHDF", "Origin", {1, 0, 0});
  h.text("/VTKHDF", "GridDescription", "XYZ");
  for (const int l : {0, 1}) {
    const std::string at = "/VTKHDF/Level" + std::to_string(l);
    h.group(at), h.group(at + "/CellData");
    const double s = l == 0 ? 1 : 0.5;
    h.numbers<double>(at, "Spacing", {s, s, s});
    h.data<int>(at + "/AMRBox", l == 0 ? std::vector<int>{0, 2, 0, 1, 0, 0} : std::vector<int>{2, 3, 0, 1, 0, 1}, {1, 6});
    std::vector<double> c(l == 0 ? 6 : 8, l);
    h.data(at + "/CellData/level", c);
  }
  h.close();
  const DatasetPtr d = read_one(h.path);
  const auto* g = d->as<AmrGrid>();
  REQUIRE(g);
  CHECK(d->cell_count() == 14);
  CHECK(g->levels[1].ratio == std::array<int, 3>{2, 2, 2});
  CHECK(d->bounds().hi.x == 4);
  const auto ghost = d->cell_ghost().view<uint8_t>();
  for (size_t i = 0; i < 14; ++i) CHECK(int(ghost[i]) == (i == 1 ? ghost_refined_cell : 0));
}

TEST_CASE("vtkhdf: blocks of a collection come in the order of their index, polyhedra with their faces") {
  H5Sample h("blocks.vtkhdf");
  h.vtkhdf("/VTKHDF", "PartitionedDataSetCollection");
  h.vtkhdf("/VTKHDF/b", "UnstructuredGrid");
  h.numbers<int64_t>("/VTKHDF/b", "Index", {0});
  h.data<int64_t>("/VTKHDF/b/NumberOfPoints", {4});
  h.data<int64_t>("/VTKHDF/b/NumberOfCells", {1});
  h.data<int64_t>("/VTKHDF/b/NumberOfConnectivityIds", {4});
  h.data<float>("/VTKHDF/b/Points", {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {4, 3});
  h.data<int64_t>("/VTKHDF/b/Connectivity", {0, 1, 2, 3});
  h.data<int64_t>("/VTKHDF/b/Offsets", {0, 4});
  h.data<uint8_t>("/VTKHDF/b/Types", {42});
  h.data<int64_t>("/VTKHDF/b/NumberOfFaces", {4});
  h.data<int64_t>("/VTKHDF/b/NumberOfFaceConnectivityIds", {12});
  h.data<int64_t>("/VTKHDF/b/NumberOfPolyhedronToFaceIds", {4});
  h.data<int64_t>("/VTKHDF/b/FaceConnectivity", {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2});
  h.data<int64_t>("/VTKHDF/b/FaceOffsets", {0, 3, 6, 9, 12});
  h.data<int64_t>("/VTKHDF/b/PolyhedronToFaces", {3, 0, 1, 2});
  h.data<int64_t>("/VTKHDF/b/PolyhedronOffsets", {0, 4});
  h.vtkhdf("/VTKHDF/a", "ImageData");
  h.numbers<int64_t>("/VTKHDF/a", "Index", {1});
  h.numbers<int64_t>("/VTKHDF/a", "WholeExtent", {0, 1, 0, 1, 0, 1});
  h.group("/VTKHDF/Assembly");
  h.close();
  const auto c = std::get<CollectionPtr>(test::read_any(h.path));
  REQUIRE(c->parts.size() == 2);
  CHECK(c->parts[0].name == "b");
  const auto* m = std::get<DatasetPtr>(c->parts[0].data)->as<UnstructuredMesh>();
  REQUIRE(m);
  CHECK(m->faces.size() == 4);
  CHECK(cells_view(m->faces).point(0, 1) == 3);
  CHECK(std::get<DatasetPtr>(c->parts[1].data)->point_count() == 8);
}

TEST_CASE("vtkhdf: what is no VTKHDF is refused with what the file holds") {
  H5Sample other("other.h5");
  other.group("/Results"), other.data<int>("/counts", {1, 2});
  other.close();
  const std::string message = test::error_of([&] { test::read_any(other.path); });
  CHECK(contains(message, "it contains Results/, counts"));
  CHECK(contains(message, "VTKHDF"));
  H5Sample tree("tree.vtkhdf");
  tree.vtkhdf("/VTKHDF", "HyperTreeGrid");
  tree.close();
  CHECK(contains(test::error_of([&] { test::read_any(tree.path); }), "type 'HyperTreeGrid'"));
}
