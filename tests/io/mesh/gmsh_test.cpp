// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <set>

#include "data/cells/cell_topology.h"
#include "io/gmsh/elements.h"
#include "io/text/mesh_text.h"
#include "mesh_robust.h"

using namespace sg;
using test::put_bytes;

namespace {

// A square of two triangles and a line, with names, a node field in two steps, and values at the nodes of elements.
std::string ascii_22() {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
         "$PhysicalNames\n2\n1 7 \"the edge\"\n2 9 \"inside\"\n$EndPhysicalNames\n"
         "$Nodes\n4\n10 0 0 0\n20 1 0 0\n30 1 1 0\n40 0 1 0\n$EndNodes\n"
         "$Elements\n3\n5 1 2 7 3 10 20\n6 2 4 9 1 1 2 10 20 30\n8 2 4 9 1 1 3 10 30 40\n$EndElements\n"
         "$Periodic\n1\n0 1 2\n1\n10 20\n$EndPeriodic\n"
         "$NodeData\n1\n\"T\"\n1\n0\n3\n0 1 4\n10 1\n20 2\n30 3\n40 4\n$EndNodeData\n"
         "$NodeData\n1\n\"T\"\n1\n0.5\n3\n1 1 3\n10 11\n20 12\n30 13\n$EndNodeData\n"
         "$ElementData\n1\n\"q\"\n1\n0\n3\n0 3 1\n8 1 2 3\n$EndElementData\n"
         "$ElementNodeData\n1\n\"jump\"\n1\n0\n3\n0 1 2\n6 3 1 2 3\n8 3 1 7 4\n$EndElementNodeData\n";
}

std::string binary_41(bool big_endian) {
  std::string s = "$MeshFormat\n4.1 1 8\n";
  put_bytes<int32_t>(s, 1, big_endian);
  s += "\n$EndMeshFormat\n$Entities\n";
  for (int64_t n : {0, 0, 1, 0}) put_bytes<int64_t>(s, n, big_endian);
  put_bytes<int32_t>(s, 4, big_endian);
  for (int k = 0; k < 6; ++k) put_bytes<double>(s, 0, big_endian);
  put_bytes<int64_t>(s, 1, big_endian), put_bytes<int32_t>(s, -9, big_endian), put_bytes<int64_t>(s, 0, big_endian);
  s += "\n$EndEntities\n$Nodes\n";
  for (int64_t n : {1, 3, 1, 1000000}) put_bytes<int64_t>(s, n, big_endian);
  for (int32_t n : {2, 4, 1}) put_bytes<int32_t>(s, n, big_endian);
  put_bytes<int64_t>(s, 3, big_endian);
  for (int64_t n : {1, 1000, 1000000}) put_bytes<int64_t>(s, n, big_endian);
  for (double x : {0.0, 0.0, 0.0, 0.1, 0.2, 1.0, 0.0, 0.0, 0.1, 0.2, 0.0, 1.0, 0.0, 0.1, 0.2}) put_bytes<double>(s, x, big_endian);
  s += "\n$EndNodes\n$Elements\n";
  for (int64_t n : {1, 1, 1, 1}) put_bytes<int64_t>(s, n, big_endian);
  for (int32_t n : {2, 4, 2}) put_bytes<int32_t>(s, n, big_endian);
  put_bytes<int64_t>(s, 1, big_endian);
  for (int64_t n : {5, 1, 1000, 1000000}) put_bytes<int64_t>(s, n, big_endian);
  s += "\n$EndElements\n$NodeData\n1\n\"T\"\n1\n0\n3\n0\n1\n2\n";
  put_bytes<int32_t>(s, 1, big_endian), put_bytes<double>(s, 5, big_endian), put_bytes<int32_t>(s, 1000000, big_endian),
      put_bytes<double>(s, 6, big_endian);
  return s + "\n$EndNodeData\n";
}

}  // namespace

TEST_CASE("gmsh: the nodes of quadratic elements come in VTK's order") {
  // The permutations that follow from the pictures of both manuals.
  const std::vector<std::pair<int, std::vector<uint32_t>>> known{
      {8, {0, 1, 2}},
      {9, {0, 1, 2, 3, 4, 5}},
      {10, {0, 1, 2, 3, 4, 5, 6, 7, 8}},
      {11, {0, 1, 2, 3, 4, 5, 6, 7, 9, 8}},
      {16, {0, 1, 2, 3, 4, 5, 6, 7}},
      {17, {0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15}},
      {12, {0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26}},
      {18, {0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11}},
      {13, {0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16}},
      {19, {0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12}}};
  for (const auto& [number, from] : known) {
    CAPTURE(number);
    REQUIRE(gmsh::element_type(number) != nullptr);
    CHECK(gmsh::element_type(number)->from == from);
  }
}

TEST_CASE("gmsh: every order lists each lattice place once, inner nodes like a smaller element") {
  for (CellType shape : {CellType::line, CellType::triangle, CellType::quad, CellType::tetra, CellType::hexahedron, CellType::wedge})
    for (int n = 1; n <= 10; ++n) {
      CAPTURE(int(shape));
      CAPTURE(n);
      const auto ours = lattice_places(shape, n), file = gmsh::node_places(shape, n);
      CHECK(std::set(ours.begin(), ours.end()) == std::set(file.begin(), file.end()));
      CHECK(ours.size() == file.size());
    }
  using Place = std::array<int, 3>;
  const auto quad = gmsh::node_places(CellType::quad, 3);
  CHECK(quad[4] == Place{1, 0, 0});
  CHECK(quad[8] == Place{2, 3, 0});
  CHECK(quad[12] == Place{1, 1, 0});
  CHECK(quad[14] == Place{2, 2, 0});
  const auto tetra = gmsh::node_places(CellType::tetra, 3);
  CHECK(tetra[10] == Place{0, 0, 2});  // edge 3-0 runs down
  CHECK(tetra[16] == Place{1, 1, 0});  // face 0 2 1
  CHECK(tetra[19] == Place{1, 1, 1});  // face 3 1 2
  const auto hexahedron = gmsh::node_places(CellType::hexahedron, 3);
  CHECK(hexahedron[10] == Place{0, 1, 0});  // edge 0-3
  CHECK(hexahedron[32] == Place{1, 1, 0});
  CHECK(hexahedron[33] == Place{1, 2, 0});  // face 0 3 2 1
  CHECK(hexahedron[56] == Place{1, 1, 1});
}

TEST_CASE("gmsh: groups, names, steps and data of version 2.2") {
  Context context;
  const DatasetPtr d = test::read_text("a.msh", ascii_22());
  CHECK(d->point_count() == 5);  // node 30 has two values of 'jump'
  CHECK(d->cell_count() == 3);
  const auto& f = d->fields();
  CHECK(f.require("physical").array.get(0) == 7);
  CHECK(f.require("entity").array.get(0) == 3);
  CHECK(f.require("partition").array.get(2) == 3);
  REQUIRE(d->notes().size() == 1);
  CHECK(d->notes()[0] == std::pair<std::string, std::string>("labels of physical", "7=the edge\n9=inside"));
  CHECK_FALSE(f.find("group"));
  CHECK(f.require("T").array.get(3) == 4);
  CHECK(std::isnan(f.require("q").array.get(0)));
  CHECK(f.require("q").array.get(2, 1) == 2);
  const auto& m = *d->as<UnstructuredMesh>();
  const CellsView cells = cells_view(m.cells);
  const Array jump = f.require("jump").array;
  CHECK(cells.point(1, 2) != cells.point(2, 1));
  CHECK(m.points.at(size_t(cells.point(1, 2))) == m.points.at(size_t(cells.point(2, 1))));
  CHECK(jump.get(size_t(cells.point(1, 2))) == 3);
  CHECK(jump.get(size_t(cells.point(2, 1))) == 7);
  CHECK(jump.get(size_t(cells.point(1, 0))) == 1);

  // A curve and a surface may share a number: then all groups are numbered anew, and those without a name get one.
  std::string both = ascii_22();
  both.replace(both.find("2 9 \"inside\""), 12, "2 7 \"face\"");
  both.replace(both.find("6 2 4 9"), 7, "6 2 4 7");
  const DatasetPtr shared = test::read_text("b.msh", both);
  CHECK(shared->fields().require("physical").array.get(1) == 7);
  const Array group = shared->fields().require("group").array;
  CHECK(group.get(0) == 1);
  CHECK(group.get(1) == 2);
  CHECK(group.get(2) == 3);
  REQUIRE(shared->notes().size() == 1);
  CHECK(shared->notes()[0] == std::pair<std::string, std::string>("labels of group", "1=the edge\n2=face\n3=surfaces 9"));

  CHECK(file_times(test::temp_folder() + "a.msh", {}, context) == std::vector<double>{0, 0.5});
  ReadOptions late;
  late.step = 1;
  const DatasetPtr second = test::read_text("a.msh", ascii_22(), late);
  CHECK(second->time() == 0.5);
  CHECK(second->fields().require("T").array.get(1) == 12);
  CHECK(std::isnan(second->fields().require("T").array.get(3)));
  ReadOptions one;
  one.fields = {"T"};
  CHECK(test::read_text("a.msh", ascii_22(), one)->fields().find("jump") == nullptr);
}

TEST_CASE("gmsh: binary 4.1 in both byte orders, sparse tags and parametric nodes") {
  for (bool big_endian : {false, true}) {
    const DatasetPtr d = test::read_text("b.msh", binary_41(big_endian));
    CHECK(d->point_count() == 3);
    CHECK(d->bounds().hi == Vec3(1, 1, 0));
    CHECK(d->fields().require("physical").array.get(0) == 9);
    CHECK(d->fields().require("entity").array.get(0) == 4);
    CHECK(d->fields().require("T").array.get(2) == 6);
    CHECK(std::isnan(d->fields().require("T").array.get(1)));
  }
}

TEST_CASE("gmsh: binary 2.2 and 4.0 blocks") {
  std::string s = "$MeshFormat\n2.2 1 8\n";
  put_bytes<int32_t>(s, 1);
  s += "\n$EndMeshFormat\n$Nodes\n3\n";
  for (int k = 0; k < 3; ++k) {
    put_bytes<int32_t>(s, k + 1);
    for (int a = 0; a < 3; ++a) put_bytes<double>(s, a == k ? 1 : 0);
  }
  s += "\n$EndNodes\n$Elements\n1\n";
  for (int32_t n : {2, 1, 2, 77, 5, 6, 1, 2, 3}) put_bytes<int32_t>(s, n);
  s += "\n$EndElements\n";
  const DatasetPtr d = test::read_text("c.msh", s);
  CHECK(d->cell_count() == 1);
  CHECK(d->fields().require("physical").array.get(0) == 5);
  CHECK(d->bounds().hi == Vec3(1, 1, 1));
  const std::string four =
      "$MeshFormat\n4.0 0 8\n$EndMeshFormat\n$Nodes\n1 3\n1 2 0 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n"
      "$Elements\n1 1\n1 2 2 1\n1 1 2 3\n$EndElements\n";
  const DatasetPtr e = test::read_text("d.msh", four);
  CHECK(e->cell_count() == 1);
  CHECK(e->fields().require("entity").array.get(0) == 1);
}

TEST_CASE("gmsh: elements that no cell is equal to are refused by name") {
  std::string s = ascii_22();
  const size_t at = s.find("6 2 4 9");
  s.replace(at, 3, "6 20");
  const std::string message = test::error_of([&] { test::read_bytes("e.msh", s); });
  CHECK(message.find("element type 20 is not supported") != std::string::npos);
  CHECK(message.find("line ") != std::string::npos);
  std::string missing = ascii_22();
  missing.replace(missing.find("10 20 30"), 8, "10 20 31");
  CHECK(test::error_of([&] { test::read_bytes("f.msh", missing); }).find("node 31") != std::string::npos);
  CHECK(test::error_of([&] { test::read_bytes("g.msh", "$MeshFormat\n3.0 0 8\n$EndMeshFormat\n"); }).find("version 3") !=
        std::string::npos);
  CHECK(test::error_of([&] { test::read_bytes("h.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"); }).find("no nodes") != std::string::npos);
}

TEST_CASE("gmsh: cut and damaged files are refused") {
  test::check_survives("robust.msh", ascii_22());
  test::check_survives_sizes("robust.msh", ascii_22());
  test::check_survives("robust.msh", binary_41(false));
}
