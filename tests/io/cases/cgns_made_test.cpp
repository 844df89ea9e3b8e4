// SPDX-License-Identifier: Apache-2.0
// CGNS files of our own: element types, polyhedra, rind planes, time steps.
#include <sys/stat.h>

#include <filesystem>

#include "cgns_file.h"
#include "io/cases/case_files.h"

using namespace sg;
using namespace sg::test;

namespace {

DatasetPtr only(const Data& data) {
  DatasetPtr found;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { found = d; });
  REQUIRE(found);
  return found;
}

std::string types_of(const Dataset& d) {
  std::string s;
  for (const auto& [name, n] : cell_type_counts(d.mesh())) s += std::string(name) + std::to_string(n) + " ";
  return s;
}

}  // namespace

TEST_CASE("cgns: elements of every type are VTK's, in both containers" * doctest::skip(no_cgns())) {
  struct Case {
    int type, nodes, dimension;
    const char* name;
    int points;
  };
  for (const Case c : {Case{3, 2, 1, "Line", 2},
                       {4, 3, 1, "QuadraticEdge", 3},
                       {5, 3, 2, "Triangle", 3},
                       {6, 6, 2, "QuadraticTriangle", 6},
                       {7, 4, 2, "Quad", 4},
                       {8, 8, 2, "QuadraticQuad", 8},
                       {9, 9, 2, "BiQuadraticQuad", 9},
                       {10, 4, 3, "Tetra", 4},
                       {11, 10, 3, "QuadraticTetra", 10},
                       {12, 5, 3, "Pyramid", 5},
                       {13, 14, 3, "QuadraticPyramid", 13},
                       {21, 13, 3, "QuadraticPyramid", 13},
                       {14, 6, 3, "Wedge", 6},
                       {15, 15, 3, "QuadraticWedge", 15},
                       {16, 18, 3, "BiQuadraticQuadraticWedge", 18},
                       {17, 8, 3, "Hexahedron", 8},
                       {18, 20, 3, "QuadraticHexahedron", 20},
                       {19, 27, 3, "TriQuadraticHexahedron", 27}}) {
    CAPTURE(c.type);
    const std::string path = temp_folder() + "type.cgns";
    {
      CgnsFile f(path, c.type % 2 == 0);
      const double z = f.zone(f.base("B", c.dimension, 3), "Z", "Unstructured", {c.nodes, 1, 0}, 1);
      f.line_of_points(z, c.nodes);
      f.section(z, "E", c.type, 1, 1, first_numbers(c.nodes));
    }
    const DatasetPtr d = only(read_any(path));
    CHECK(types_of(*d) == std::string(c.name) + "1 ");
    const auto& mesh = *d->as<UnstructuredMesh>();
    const CellsView cells = cells_view(mesh.cells);
    CHECK(int(cells.size(0)) == c.points);
    if (c.type == 19) {  // SIDS: vertical edges before the upper ones, lower face, sides, upper face
      const int expected[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15, 24, 22, 21, 23, 20, 25, 26};
      for (size_t k = 0; k < 27; ++k) CHECK(cells.point(0, k) == expected[k]);
    }
  }
}

TEST_CASE("cgns: mixed sections read with and without offsets; cells of lower dimension are left out" * doctest::skip(no_cgns())) {
  for (const bool offsets : {true, false}) {
    const std::string path = temp_folder() + "mixed.cgns";
    {
      CgnsFile f(path, offsets);
      const double z = f.zone(f.base("B", 3, 3), "Z", "Unstructured", {8, 2, 0}, 1);
      f.line_of_points(z, 8);
      // a tetrahedron, a triangle, a pyramid
      f.section(z, "M", 20, 1, 3, {10, 1, 2, 3, 4, 5, 1, 2, 3, 12, 1, 2, 3, 4, 8},
                offsets ? std::vector<int>{0, 5, 9, 15} : std::vector<int>{});
      f.section(z, "Wall", 7, 4, 4, {1, 2, 3, 4});
      const double s = f.node(z, "Solution", "FlowSolution_t");
      f.text(s, "GridLocation", "GridLocation_t", "CellCenter");
      f.add(s, "p", "DataArray_t", std::vector<float>{5, 6});
    }
    const DatasetPtr d = only(read_any(path));
    CHECK(types_of(*d) == "Tetra1 Pyramid1 ");
    CHECK(d->fields().require("p").array.get(1) == 6);
    CHECK(cells_view(d->as<UnstructuredMesh>()->cells).point(1, 4) == 7);
  }
}

TEST_CASE("cgns: polyhedra of NGON_n and NFACE_n, new and old" * doctest::skip(no_cgns())) {
  for (const bool offsets : {true, false}) {
    const std::string path = temp_folder() + "poly.cgns";
    {
      CgnsFile f(path, offsets);
      const double z = f.zone(f.base("B", 3, 3), "Z", "Unstructured", {6, 1, 0}, 1);
      f.line_of_points(z, 6);
      if (offsets) {
        f.section(z, "Faces", 22, 1, 5, {1, 3, 2, 4, 5, 6, 1, 2, 5, 4, 2, 3, 6, 5, 3, 1, 4, 6}, {0, 3, 6, 10, 14, 18});
        f.section(z, "Cells", 23, 6, 6, {1, -2, 3, 4, 5}, {0, 5});
      } else {
        f.section(z, "Faces", 22, 1, 5, {3, 1, 3, 2, 3, 4, 5, 6, 4, 1, 2, 5, 4, 4, 2, 3, 6, 5, 4, 3, 1, 4, 6});
        f.section(z, "Cells", 23, 6, 6, {5, 1, -2, 3, 4, 5});
      }
    }
    const DatasetPtr d = only(read_any(path));
    CHECK(types_of(*d) == "Polyhedron1 ");
    const auto& mesh = *d->as<UnstructuredMesh>();
    CHECK(cells_view(mesh.cells).size(0) == 6);
    const CellsView faces = cells_view(mesh.faces);
    REQUIRE(faces.count == 5);
    CHECK(faces.point(0, 0) == 0);
    CHECK(faces.point(1, 0) == 5);  // the second face is seen from its other side
    CHECK(faces.size(2) == 4);
  }
}

TEST_CASE("cgns: rind planes are cut away, 2D velocities become vectors" * doctest::skip(no_cgns())) {
  const std::string path = temp_folder() + "rind.cgns";
  {
    CgnsFile f(path, true);
    const double z = f.zone(f.base("B", 2, 2), "Z", "Structured", {3, 2, 2, 1, 0, 0}, 2);
    const double g = f.node(z, "GridCoordinates", "GridCoordinates_t");
    f.add(g, "CoordinateX", "DataArray_t", std::vector<double>{0, 1, 2, 0, 1, 2}, {3, 2});
    f.add(g, "CoordinateY", "DataArray_t", std::vector<double>{0, 0, 0, 1, 1, 1}, {3, 2});
    const double s = f.node(z, "S", "FlowSolution_t");
    f.text(s, "GridLocation", "GridLocation_t", "CellCenter");
    f.add(s, "Rind", "Rind_t", std::vector<int>{1, 0, 0, 1});
    f.add(s, "VelocityX", "DataArray_t", std::vector<float>{-1, 10, 11, -1, -1, -1}, {3, 2});  // 1+2 by 1+1 cells
    f.add(s, "VelocityY", "DataArray_t", std::vector<float>{-1, 20, 21, -1, -1, -1}, {3, 2});
    f.text(z, "FamilyName", "FamilyName_t", "inlet");
  }
  const DatasetPtr d = only(read_any(path));
  const auto* grid = d->as<CurvilinearGrid>();
  REQUIRE(grid);
  CHECK(grid->dims == std::array<size_t, 3>{3, 2, 1});
  const Field& v = d->fields().require("Velocity");
  CHECK(v.components() == 3);
  CHECK(v.array.type() == ElementType::f32);
  CHECK(v.array.get(0, 0) == 10);
  CHECK(v.array.get(1, 1) == 21);
  CHECK(v.array.get(1, 2) == 0);
  CHECK(d->notes().back() == std::pair<std::string, std::string>("family", "inlet"));
  check_names_alone(path);
}

TEST_CASE("cgns: a step takes the solution that the zone names for it" * doctest::skip(no_cgns())) {
  const std::string path = temp_folder() + "steps.cgns";
  {
    CgnsFile f(path, false);
    const double b = f.base("B", 3, 3);
    const double it = f.add(b, "Times", "BaseIterativeData_t", std::vector<int>{2});
    f.add(it, "TimeValues", "DataArray_t", std::vector<double>{0.25, 0.5});
    const double z = f.zone(b, "Z", "Unstructured", {4, 1, 0}, 1);
    f.line_of_points(z, 4);
    f.section(z, "E", 10, 1, 1, {1, 2, 3, 4});
    for (int k = 0; k < 2; ++k) {
      const double s = f.node(z, k ? "Late" : "Early", "FlowSolution_t");
      f.add(s, "T", "DataArray_t", std::vector<double>(4, k ? 2. : 1.));
    }
    std::string names = "Early";
    names.resize(32, ' ');
    names += "Late";
    names.resize(64, ' ');
    f.text(f.node(z, "Steps", "ZoneIterativeData_t"), "FlowSolutionPointers", "DataArray_t", names, {32, 2});
  }
  Context context;
  CHECK(file_times(path, {}, context) == std::vector<double>{0.25, 0.5});
  CHECK(only(read_any(path))->fields().require("T").array.get(0) == 1);
  ReadOptions o;
  o.time = 0.6;
  const DatasetPtr d = only(read_any(path, o));
  CHECK(d->fields().require("T").array.get(0) == 2);
  CHECK(*d->time() == 0.5);
}

TEST_CASE("cgns: wrong connectivity is told with its node" * doctest::skip(no_cgns())) {
  const auto message = [](int type, const std::vector<int>& ids, const std::vector<int>& starts, int last = 1) {
    const std::string path = temp_folder() + "wrong.cgns";
    {
      CgnsFile f(path, false);
      const double z = f.zone(f.base("B", 3, 3), "Z", "Unstructured", {4, 1, 0}, 1);
      f.line_of_points(z, 4);
      f.section(z, "E", type, 1, last, ids, starts);
    }
    return error_of([&] { read_any(path); });
  };
  CHECK(contains(message(10, {1, 2, 3, 5}, {}), "point id 4"));
  CHECK(contains(message(10, {1, 2, 3, 0}, {}), "point id -1"));
  CHECK(contains(message(10, {1, 2, 3}, {}), "/B/Z/E"));
  CHECK(contains(message(10, {1, 2, 3, 4}, {}, 2147483647), "/B/Z/E"));
  CHECK(contains(message(39, {1, 2, 3, 4}, {}), "type 39"));
  CHECK(contains(message(20, {10, 1, 2, 3}, {}), "list ends"));
  CHECK(contains(message(20, {10, 1, 2, 3, 4}, {0, 9}), "ElementStartOffset"));
  CHECK(contains(message(22, {5, 1, 2}, {}), "list ends"));
  CHECK(contains(message(23, {1, 2, 3, 4}, {0, 4}), "not a polygon"));
}

TEST_CASE("cgns: links lead below the folder of the file or the working folder, to files, and nowhere else" * doctest::skip(no_cgns())) {
  const std::string inside = temp_folder() + "cgns_links/";
  std::filesystem::create_directories(inside);
  for (const bool hdf5 : {false, true}) {
    INFO(hdf5);
    for (const std::string& at : {inside + "mesh.cgns", temp_folder() + "cgns_outside.cgns"}) {
      std::filesystem::remove(at);
      CgnsFile f(at, hdf5);
      const double zone = f.zone(f.base("Base", 1, 3), "Zone", "Unstructured", {3, 2, 0}, 1);
      f.line_of_points(zone, 3);
      f.section(zone, "Lines", 3, 1, 2, {1, 2, 2, 3});
    }
    const auto said = [&](const std::string& to) {
      std::filesystem::remove(inside + "here.cgns");
      CgnsFile f(inside + "here.cgns", hdf5);
      f.link(f.base("Base", 1, 3), "Zone", to, "/Base/Zone");
      f.close();
      try {
        read_any(inside + "here.cgns");
        return std::string();
      } catch (const Error& e) {
        return std::string(e.what());
      }
    };
    CHECK(said("mesh.cgns") == "");
    CHECK(said("../cgns_outside.cgns").find("--read-anywhere") != std::string::npos);
    CHECK(said(temp_folder() + "cgns_outside.cgns").find("--read-anywhere") != std::string::npos);
    if (hdf5) REQUIRE(::mkfifo((inside + "pipe").c_str(), 0600) == 0);
    else std::filesystem::remove(inside + "pipe");
    CHECK(said("pipe") != "");
  }
}
