// SPDX-License-Identifier: Apache-2.0
// Exodus II meshes in small classic netCDF files.
#include "data/cells/cell_topology.h"
#include "io/cases/case_files.h"
#include "io/mesh/node_order.h"
#include "io/netcdf/netcdf_bytes.h"
#include "io/volume/component_names.h"

using namespace sg;
using namespace sg::test;

namespace {

// One element of `nodes` nodes on nodes of its own, at (k, 10k, 100k), in a block of the given name.
std::string one_element(const std::string& type, int nodes, int space = 3) {
  NcBytes f;
  const int n = f.dim("num_nodes", size_t(nodes)), per = f.dim("num_nod_per_el1", size_t(nodes)), one = f.dim("num_el_in_blk1", 1);
  f.dim("num_el_blk", 1), f.dim("num_dim", size_t(space)), f.dim("num_elem", 1);
  std::vector<double> x, y, z;
  for (int k = 0; k < nodes; ++k) x.push_back(k), y.push_back(10 * k), z.push_back(100 * k);
  f.var<double>("coordx", {n}, x).var<double>("coordy", {n}, y);
  if (space == 3) f.var<double>("coordz", {n}, z);
  f.var<int32_t>("connect1", {one, per}, first_numbers(nodes)).att("elem_type", type);
  return f.bytes();
}

// Two unit cubes side by side and a tetrahedron: variables, sets, maps, two steps.
std::string cubes(int version = 2) {
  NcBytes f(version);
  const int time = f.dim("time_step", 0), n = f.dim("num_nodes", 13), hexes = f.dim("num_el_in_blk1", 2),
            eight = f.dim("num_nod_per_el1", 8);
  const int tets = f.dim("num_el_in_blk2", 1), four = f.dim("num_nod_per_el2", 4), blocks = f.dim("num_el_blk", 2),
            len = f.dim("len_name", 33);
  const int all = f.dim("num_elem", 3), nodal = f.dim("num_nod_var", 4), elemental = f.dim("num_elem_var", 1),
            global = f.dim("num_glo_var", 1);
  const int sides = f.dim("num_side_ss1", 3), side_sets = f.dim("num_side_sets", 1), node_sets = f.dim("num_node_sets", 1);
  const int members = f.dim("num_nod_ns1", 2);
  f.dim("num_dim", 3);
  f.records(2).att("title", "two cubes");
  f.var<double>("time_whole", {time}, {0.5, 1.5});
  f.var<double>("coordx", {n}, {0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 9});
  f.var<double>("coordy", {n}, {0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1, 9});
  f.var<double>("coordz", {n}, {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 9});
  f.var<int32_t>("connect1", {hexes, eight}, {1, 2, 5, 4, 7, 8, 11, 10, 2, 3, 6, 5, 8, 9, 12, 11}).att("elem_type", "hex");
  f.var<int32_t>("connect2", {tets, four}, {1, 2, 4, 7}).att("elem_type", "TETRA");
  f.var<int32_t>("eb_prop1", {blocks}, {20, 10}).words("eb_names", {blocks, len}, {"cubes", ""});
  f.words("name_nod_var", {nodal, len}, {"VX", "VY", "VZ", "T"});
  std::vector<double> vx, t;
  for (int s = 0; s < 2; ++s)
    for (int k = 0; k < 13; ++k) vx.push_back(k + 100 * s), t.push_back(-k);
  f.var<double>("vals_nod_var1", {time, n}, vx).var<double>("vals_nod_var2", {time, n}, t).var<double>("vals_nod_var3", {time, n}, vx);
  f.var<double>("vals_nod_var4", {time, n}, t);
  f.words("name_elem_var", {elemental, len}, {"stress"}).var<double>("vals_elem_var1eb1", {time, hexes}, {1, 2, 3, 4});
  f.words("name_glo_var", {global, len}, {"energy"}).var<double>("vals_glo_var", {time, global}, {7, 8});
  f.var<int32_t>("ss_prop1", {side_sets}, {5}).words("ss_names", {side_sets, len}, {"wall"});
  f.var<int32_t>("elem_ss1", {sides}, {1, 2, 3}).var<int32_t>("side_ss1", {sides}, {4, 2, 1});
  f.var<int32_t>("ns_prop1", {node_sets}, {6}).var<int32_t>("node_ns1", {members}, {13, 1});
  f.var<int32_t>("elem_num_map", {all}, {100, 200, 300});
  return f.bytes();
}

}  // namespace

TEST_CASE("node order: every list of VTK nodes is without repetition and in itself in order") {
  for (int t = 0; t < 80; ++t) {
    const auto nodes = vtk_nodes(CellType(t));
    if (nodes.empty()) continue;
    CAPTURE(t);
    CHECK(int(nodes.size()) == cell_type_info(CellType(t)).points);
    const std::vector<uint8_t> order = node_order(CellType(t), nodes);
    REQUIRE(order.size() == nodes.size());
    for (size_t k = 0; k < order.size(); ++k) CHECK(order[k] == k);
  }
  CHECK(node_order(CellType::quadratic_tetra, vtk_nodes(CellType::tetra)).empty());
}

TEST_CASE("node order: sides found by their corners are the faces of the cell tables, with their mid nodes") {
  for (const CellType t :
       {CellType::tetra, CellType::quadratic_tetra, CellType::pyramid, CellType::quadratic_pyramid, CellType::wedge,
        CellType::quadratic_wedge, CellType::hexahedron, CellType::quadratic_hexahedron, CellType::triquadratic_hexahedron}) {
    CAPTURE(int(t));
    const auto nodes = vtk_nodes(t);
    const CellFaces& faces = cell_faces(t, nodes.size());
    for (size_t f = 0; f < faces.size(); ++f) {
      std::vector<uint8_t> corners;
      for (const uint32_t c : faces.face_corners(f)) corners.push_back(uint8_t(c));
      const CellSide side = cell_side(corners, nodes);
      CHECK(side.type == faces.type[f]);
      const auto expected = faces.face(f);
      REQUIRE(side.nodes.size() == expected.size());
      for (size_t k = 0; k < expected.size(); ++k) CHECK(side.nodes[k] == expected[k]);
    }
  }
}

TEST_CASE("component names: X Y Z make vectors, six and nine ends make tensors, the rest stays") {
  const auto joined = [](const std::vector<std::string>& names, bool flat) {
    std::string s;
    for (const NameGroup& g : group_components(names, flat)) {
      s += g.name + ":";
      for (const size_t k : g.members) s += std::to_string(k);
      s += " ";
    }
    return s;
  };
  CHECK(joined({"T", "VelocityX", "VelocityZ", "VelocityY", "p"}, false) == "T:0 Velocity:132 p:4 ");
  CHECK(joined({"u_x", "u_y"}, false) == "u_x:0 u_y:1 ");
  CHECK(joined({"u_x", "u_y"}, true) == "u_:01 ");
  CHECK(joined({"sxx", "syy", "szz", "sxy", "syz", "szx"}, false) == "s:012345 ");
  CHECK(joined({"sxx", "sxy", "sxz", "syx", "syy", "syz", "szx", "szy", "szz"}, false) == "s:012345678 ");
  CHECK(joined({"X", "Y", "Z"}, true) == "X:0 Y:1 Z:2 ");
  CHECK(joined({"vx", "VY", "vz", "max"}, true) == "vx:0 VY:1 vz:2 max:3 ");
}

TEST_CASE("exodus: elements of every shape have their type and VTK's node order") {
  struct Case {
    const char* name;
    int nodes;
    const char* type;
    int points;
  };
  for (const Case c : {Case{"HEX8", 8, "Hexahedron", 8},
                       {"hex", 20, "QuadraticHexahedron", 20},
                       {"HEX27", 27, "TriQuadraticHexahedron", 27},
                       {"HEX21", 21, "QuadraticHexahedron", 20},
                       {"TET4", 4, "Tetra", 4},
                       {"tetra", 10, "QuadraticTetra", 10},
                       {"TET11", 11, "QuadraticTetra", 10},
                       {"TETRA8", 8, "Tetra", 4},
                       {"WEDGE", 6, "Wedge", 6},
                       {"WEDGE15", 15, "QuadraticWedge", 15},
                       {"WEDGE16", 16, "QuadraticWedge", 15},
                       {"WEDGE18", 18, "BiQuadraticQuadraticWedge", 18},
                       {"PYRAMID", 5, "Pyramid", 5},
                       {"PYRAMID13", 13, "QuadraticPyramid", 13},
                       {"QUAD", 4, "Quad", 4},
                       {"quad8", 8, "QuadraticQuad", 8},
                       {"QUAD9", 9, "BiQuadraticQuad", 9},
                       {"TRI", 3, "Triangle", 3},
                       {"TRI6", 6, "QuadraticTriangle", 6},
                       {"TRI7", 7, "BiQuadraticTriangle", 7},
                       {"SHELL", 4, "Quad", 4},
                       {"SHELL3", 3, "Triangle", 3},
                       {"TRISHELL", 3, "Triangle", 3},
                       {"BAR2", 2, "Line", 2},
                       {"BEAM", 3, "QuadraticEdge", 3},
                       {"truss", 2, "Line", 2},
                       {"SPHERE", 1, "Vertex", 1},
                       {"circle", 1, "Vertex", 1},
                       {"", 8, "Hexahedron", 8}}) {
    CAPTURE(c.name);
    const Data data = read_bytes("one.exo", one_element(c.name, c.nodes));
    const DatasetPtr d = leaf_named(data, "Element Blocks/Unnamed block ID: 1");
    const auto counts = cell_type_counts(d->mesh());
    REQUIRE(counts.size() == 1);
    CHECK(counts[0].first == c.type);
    CHECK(int(d->point_count()) == c.points);
  }
  // The nodes between corners: Exodus lists those of the vertical edges before those of the upper face.
  const DatasetPtr d = leaf_named(read_bytes("one.exo", one_element("HEX27", 27)), "Element Blocks/Unnamed block ID: 1");
  const auto& mesh = *d->as<UnstructuredMesh>();
  const CellsView cells = cells_view(mesh.cells);
  const int expected[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15, 23, 24, 25, 26, 21, 22, 20};
  for (size_t k = 0; k < 27; ++k) CHECK(mesh.points.at(size_t(cells.point(0, k))).x == expected[k]);
}

TEST_CASE("exodus: blocks, sets, variables and maps of two steps") {
  for (const int version : {1, 2, 5}) {
    ReadOptions o;
    o.step = 1;
    const Data data = read_bytes("cubes.e", cubes(version), o);
    const DatasetPtr hexes = leaf_named(data, "Element Blocks/cubes"), tet = leaf_named(data, "Element Blocks/Unnamed block ID: 10");
    CHECK(std::get<CollectionPtr>(std::get<CollectionPtr>(data)->parts[0].data)->parts[0].name == "Unnamed block ID: 10");  // by id
    CHECK(hexes->point_count() == 12);
    CHECK(hexes->cell_count() == 2);
    CHECK(tet->point_count() == 4);
    CHECK(*hexes->time() == 1.5);
    const Field& v = hexes->fields().require("V");
    CHECK(v.components() == 3);
    CHECK(v.array.get(11, 0) == 111);
    CHECK(v.array.get(11, 1) == -11);
    CHECK(hexes->fields().require("stress").array.get(1) == 4);
    CHECK(tet->fields().find("stress") == nullptr);
    CHECK(tet->fields().require("GlobalElementId").array.get(0) == 300);
    CHECK(tet->fields().require("ObjectId").array.get(0) == 10);
    CHECK(tet->fields().require("T").array.get(3) == -6);  // nodes 1 2 4 7
    CHECK(hexes->fields().require("energy").array.get(0) == 8);
    const DatasetPtr wall = leaf_named(data, "Side Sets/wall");
    const auto counts = cell_type_counts(wall->mesh());
    REQUIRE(counts.size() == 2);
    CHECK(counts[0] == std::pair<std::string_view, size_t>("Triangle", 1));
    CHECK(counts[1] == std::pair<std::string_view, size_t>("Quad", 2));
    // Side 4 of the first cube is x = 0, side 2 of the second x = 2, side 1 of the tetrahedron its nodes 1 2 7.
    const auto& mesh = *wall->as<UnstructuredMesh>();
    const CellsView cells = cells_view(mesh.cells);
    for (size_t k = 0; k < 4; ++k) CHECK(mesh.points.at(size_t(cells.point(0, k))).x == 0);
    for (size_t k = 0; k < 4; ++k) CHECK(mesh.points.at(size_t(cells.point(1, k))).x == 2);
    CHECK(mesh.points.at(size_t(cells.point(2, 2))).z == 1);
    const DatasetPtr nodes = leaf_named(data, "Node Sets/Unnamed set ID: 6");
    CHECK(nodes->bounds().hi.x == 9);
    CHECK(nodes->cell_count() == 2);
  }
}

TEST_CASE("exodus: times are told and only the wanted fields read") {
  const std::string path = temp_file("times.exo", cubes());
  Context context;
  CHECK(file_times(path, {}, context) == std::vector<double>{0.5, 1.5});
  ReadOptions o;
  o.fields = {"T"};
  const Data data = read_data(path, o, context);
  CHECK(leaf_named(data, "Element Blocks/cubes")->fields().names() == std::vector<std::string>{"T"});
  o.step = 7;
  CHECK(contains(error_of([&] { read_data(path, o, context); }), "no time step 7"));
}

TEST_CASE("exodus: the header alone tells every field, without its values") {
  for (const int version : {1, 2, 5}) {
    ReadOptions o;
    o.step = 1;
    check_names_alone(temp_file("names.exo", cubes(version)), o);
    o.fields = {"stress", "V"};
    check_names_alone(temp_file("names.exo", cubes(version)), o);
  }
}

TEST_CASE("exodus: polygons and polyhedra keep their faces, also as sides") {
  // A triangular prism as polyhedron of 5 faces; a block of one pentagon and one triangle.
  NcBytes f(2);
  const int n = f.dim("num_nodes", 6), faces = f.dim("num_fa_in_blk1", 5), ids = f.dim("num_nod_per_fa1", 18),
            one = f.dim("num_el_in_blk1", 1);
  const int five = f.dim("num_fac_per_el1", 5), two = f.dim("num_el_in_blk2", 2), eight = f.dim("num_nod_per_el2", 8),
            sides = f.dim("num_side_ss1", 2);
  f.dim("num_el_blk", 2), f.dim("num_fa_blk", 1), f.dim("num_side_sets", 1), f.dim("num_dim", 3);
  f.var<double>("coordx", {n}, {0, 1, 0, 0, 1, 0})
      .var<double>("coordy", {n}, {0, 0, 1, 0, 0, 1})
      .var<double>("coordz", {n}, {0, 0, 0, 1, 1, 1});
  f.var<int32_t>("fbconn1", {ids}, {1, 3, 2, 4, 5, 6, 1, 2, 5, 4, 2, 3, 6, 5, 3, 1, 4, 6}).att("elem_type", "NSIDED");
  f.var<int32_t>("fbepecnt1", {faces}, {3, 3, 4, 4, 4});
  f.var<int32_t>("facconn1", {five}, {1, 2, 3, 4, 5}).att("elem_type", "NFACED");
  f.var<int32_t>("ebepecnt1", {one}, {5});
  f.var<int32_t>("connect2", {eight}, {1, 2, 5, 6, 3, 1, 2, 3}).att("elem_type", "nsided");
  f.var<int32_t>("ebepecnt2", {two}, {5, 3});
  f.var<int32_t>("elem_ss1", {sides}, {1, 2}).var<int32_t>("side_ss1", {sides}, {3, 5});
  const std::string bytes = f.bytes();
  const Data data = read_bytes("poly.exo", bytes);
  const DatasetPtr solid = leaf_named(data, "Element Blocks/Unnamed block ID: 1"),
                   flat = leaf_named(data, "Element Blocks/Unnamed block ID: 2");
  const auto& mesh = *solid->as<UnstructuredMesh>();
  CHECK(mesh.type(0) == CellType::polyhedron);
  CHECK(cells_view(mesh.cells).size(0) == 6);
  CHECK(mesh.faces.size() == 5);
  CHECK(cells_view(mesh.faces).size(4) == 4);
  CHECK(flat->as<UnstructuredMesh>()->single_type == CellType::polygon);
  CHECK(cells_view(flat->as<UnstructuredMesh>()->cells).size(0) == 5);
  const DatasetPtr side = leaf_named(data, "Side Sets/Unnamed set ID: 1");
  CHECK(cells_view(side->as<UnstructuredMesh>()->cells).size(0) == 4);
  CHECK(side->as<UnstructuredMesh>()->type(1) == CellType::line);
  cut_and_damage("poly.exo", bytes);
}

TEST_CASE("exodus: wrong elements, sides and shapes are told with their place") {
  const std::string good = cubes();
  const auto with = [&](std::string_view name, size_t value, int32_t wrong) {
    // The value's place in the file: found by writing the file with and without it.
    std::string bad = good;
    const auto at = [&](const std::vector<int32_t>& list) {
      std::string bytes;
      for (const int32_t v : list)
        for (int k = 3; k >= 0; --k) bytes += char(v >> (8 * k));
      const size_t found = good.find(bytes);
      REQUIRE(found != std::string::npos);
      return found;
    };
    const size_t begin = name == "connect2" ? at({1, 2, 4, 7}) : name == "elem_ss1" ? at({1, 2, 3, 4, 2, 1}) : at({4, 2, 1});
    for (int k = 0; k < 4; ++k) bad[begin + 4 * value + size_t(k)] = char(wrong >> (24 - 8 * k));
    return refusal("wrong.e", bad);
  };
  for (const int32_t wrong : {0, -1, 14, INT32_MAX, INT32_MIN}) CHECK(contains(with("connect2", 1, wrong), "connect2"));
  CHECK(contains(with("connect2", 1, 14), "node 14"));
  CHECK(contains(with("elem_ss1", 0, 4), "elem_ss1"));
  CHECK(contains(with("elem_ss1", 1, INT32_MIN), "elem_ss1"));
  CHECK(contains(with("side_ss1", 0, 7), "1..6"));
  CHECK(contains(with("side_ss1", 2, 0), "1..4"));
  CHECK(contains(error_of([] { read_bytes("odd.exo", one_element("BLOB", 17)); }), "unknown shape"));
  CHECK(contains(error_of([] { read_bytes("odd.exo", one_element("HEX8", 5)); }), "unknown shape"));
}

TEST_CASE("exodus: cut and damaged files are refused or read") {
  const std::string good = cubes();
  CHECK(cut_and_damage("hurt.e", good) == 63);
  Context context;
  for (size_t k = 4; k < 200; ++k) {
    std::string bad = good;
    bad[k] = char(bad[k] ^ 0xff);
    try {
      read_data(temp_file("flip.e", bad), {}, context);
    } catch (const Error& e) {
      CHECK(e.kind() != ErrorKind::internal);
    }
  }
}
