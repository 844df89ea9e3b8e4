// SPDX-License-Identifier: Apache-2.0
#include "data/cells/cell_reader.h"

#include "support/test.h"

using namespace sg;

namespace {

Points points_of(std::vector<Vec3> at, Vec3 origin = {0, 0, 0}) {
  std::vector<double> xyz;
  for (Vec3 p : at) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  return {Array::from_vector(std::move(xyz), 3), origin};
}

std::vector<int64_t> ids_of(const CellReader& r) { return {r.ids().begin(), r.ids().end()}; }

}  // namespace

TEST_CASE("cell reader: a uniform grid gives voxels in VTK's node order, with its direction") {
  UniformGrid g;
  g.dims = {3, 3, 2};
  g.origin = {10, 0, 0};
  g.spacing = {1, 2, 3};
  g.direction = Mat3{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}};
  CellReader r(make_dataset(g));
  CHECK(r.count() == 4);
  r.open(3);
  CHECK(r.type() == CellType::voxel);
  CHECK(r.dimension() == 3);
  CHECK(ids_of(r) == std::vector<int64_t>{4, 5, 7, 8, 13, 14, 16, 17});
  CHECK(r.at()[0] == Vec3(8, 1, 0));
  CHECK(r.at()[1] == Vec3(8, 2, 0));
  CHECK(r.at()[7] == Vec3(6, 2, 3));
  CHECK(r.box().size() == Vec3(2, 1, 3));
  CHECK(r.face_count() == 6);
}

TEST_CASE("cell reader: a flat grid has pixels in the axes that have cells, a row has lines, a point a vertex") {
  UniformGrid g;
  g.dims = {1, 3, 3};
  CellReader r(make_dataset(g));
  r.open(2);
  CHECK(r.type() == CellType::pixel);
  CHECK(ids_of(r) == std::vector<int64_t>{3, 4, 6, 7});
  CHECK(r.at()[1] == Vec3(0, 1, 1));
  g.dims = {1, 1, 4};
  CellReader row(make_dataset(g));
  row.open(2);
  CHECK(row.type() == CellType::line);
  CHECK(ids_of(row) == std::vector<int64_t>{2, 3});
  CHECK(row.at()[1] == Vec3(0, 0, 3));
  g.dims = {1, 1, 1};
  CellReader point(make_dataset(g));
  CHECK(point.count() == 1);
  point.open(0);
  CHECK(point.type() == CellType::vertex);
}

TEST_CASE("cell reader: rectilinear and curvilinear grids keep their positions; curvilinear cells go around") {
  RectilinearGrid g;
  g.x = Array::from_vector(std::vector<float>{0, 1, 4});
  g.y = Array::from_vector(std::vector<double>{5, 3});
  g.z = Array::from_vector(std::vector<double>{7});
  CellReader r(make_dataset(g));
  r.open(1);
  CHECK(r.type() == CellType::pixel);
  CHECK(r.at()[3] == Vec3(4, 3, 7));
  CurvilinearGrid c;
  c.dims = {2, 2, 2};
  std::vector<Vec3> at;
  for (int i = 0; i < 8; ++i) at.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  c.points = points_of(at, {1e7, 0, 0});
  CellReader h(make_dataset(c));
  h.open(0);
  CHECK(h.type() == CellType::hexahedron);
  CHECK(ids_of(h) == std::vector<int64_t>{0, 1, 3, 2, 4, 5, 7, 6});
  CHECK(h.at()[2] == Vec3(1e7 + 1, 1, 0));
}

TEST_CASE("cell reader: surface cells are named by their size, a cloud gives vertices") {
  SurfaceMesh s;
  s.points = points_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}});
  auto list = [](std::vector<int32_t> ids, std::vector<int32_t> offsets) {
    return CellArray{Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  };
  s.vertices = list({4, 0, 1}, {0, 1, 3});
  s.lines = list({0, 1, 0, 1, 2}, {0, 2, 5});
  s.polygons = list({0, 1, 2, 0, 1, 2, 3, 0, 1, 2, 3, 4}, {0, 3, 7, 12});
  s.strips = list({0, 1, 2, 3}, {0, 4});
  CellReader r(make_dataset(s));
  const CellType want[] = {CellType::vertex,   CellType::poly_vertex, CellType::line,    CellType::poly_line,
                           CellType::triangle, CellType::quad,        CellType::polygon, CellType::triangle_strip};
  REQUIRE(r.count() == 8);
  for (size_t c = 0; c < 8; ++c) {
    r.open(c);
    CHECK(r.type() == want[c]);
    CHECK(r.at().size() == r.ids().size());
  }
  CHECK(ids_of(r) == std::vector<int64_t>{0, 1, 2, 3});
  CellReader cloud(make_dataset(PointCloud{s.points}));
  CHECK(cloud.count() == 5);
  cloud.open(4);
  CHECK(cloud.type() == CellType::vertex);
  CHECK(cloud.at()[0] == Vec3(0, 0, 1));
}

TEST_CASE("cell reader: AMR patches give voxels one after the other, 2D ones pixels") {
  AmrGrid g;
  g.origin = {1, 0, 0};
  AmrGrid::Patch coarse;
  coarse.lo = {0, 0, 0}, coarse.hi = {1, 1, 1};
  AmrGrid::Patch fine;
  fine.lo = {2, 2, 2}, fine.hi = {3, 2, 2}, fine.cell_offset = 8, fine.point_offset = 27;
  g.levels = {{{1, 1, 1}, {1, 1, 1}, {coarse}}, {{0.5, 0.5, 0.5}, {2, 2, 2}, {fine}}};
  DatasetParts parts;
  parts.mesh = g;
  parts.cell_ghost = Array::from_vector(std::vector<uint8_t>{0, 0, 0, 0, 0, 0, 0, ghost_refined_cell, 0, 0});
  CellReader r(make_dataset(parts));
  CHECK(r.count() == 10);
  r.open(9);
  CHECK(r.type() == CellType::voxel);
  CHECK(r.at()[0] == Vec3(2.5, 1, 1));
  CHECK(r.at()[7] == Vec3(3, 1.5, 1.5));
  CHECK(r.ids()[0] == 27 + 1);
  CHECK(r.ids()[7] == 27 + 11);
  CHECK(r.hidden(7));
  CHECK_FALSE(r.hidden(8));
  CellReader copy = r;
  copy.open(0);
  CHECK(copy.at()[0] == Vec3(1, 0, 0));
  CHECK(r.at()[0] == Vec3(2.5, 1, 1));
}

TEST_CASE("cell reader: a polyhedron's faces are places in its points; a face with a foreign point is an error") {
  UnstructuredMesh m;
  m.points = points_of({{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  m.single_type = CellType::polyhedron;
  m.cells = {Array::from_vector(std::vector<int64_t>{4, 3, 2, 1}), Array::from_vector(std::vector<int64_t>{0, 4}), 0};
  std::vector<int64_t> faces{1, 3, 2, 1, 2, 4, 2, 3, 4, 3, 1, 4};
  m.faces = {Array::from_vector(faces), Array::from_vector(std::vector<int64_t>{0, 3, 6, 9, 12}), 0};
  m.polyhedron_faces = Array::from_vector(std::vector<int64_t>{0, 4});
  CellReader r(make_dataset(m));
  r.open(0);
  CHECK(r.type() == CellType::polyhedron);
  REQUIRE(r.face_count() == 4);
  CHECK(std::vector<uint32_t>(r.face(0).begin(), r.face(0).end()) == std::vector<uint32_t>{3, 1, 2});
  faces[0] = 0;
  m.faces.connectivity = Array::from_vector(faces);
  CellReader bad(make_dataset(m));
  bad.open(0);
  CHECK(test::error_of([&] { bad.face_count(); }).find("point 0") != std::string::npos);
}

TEST_CASE("cell reader: a cell with a hidden point is hidden") {
  DatasetParts parts;
  UniformGrid g;
  g.dims = {3, 2, 1};
  parts.mesh = g;
  parts.point_ghost = Array::from_vector(std::vector<uint8_t>{ghost_hidden_point, 0, 0, 0, 0, 0});
  CellReader r(make_dataset(parts));
  CHECK(r.hidden(0));
  CHECK_FALSE(r.hidden(1));
}
