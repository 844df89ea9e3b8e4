// SPDX-License-Identifier: Apache-2.0
// XDMF without HDF5: inline and binary data.
#include <fmt/core.h>

#include <tuple>

#include "io/io_files.h"

using namespace sg;
using test::contains;
using test::refusal;

namespace {

std::string file(const std::string& domain) {
  return "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n" + domain + "\n</Domain>\n</Xdmf>\n";
}
std::string grid(const std::string& inside, const std::string& name = "g") {
  return "<Grid Name=\"" + name + "\" GridType=\"Uniform\">\n" + inside + "</Grid>\n";
}
std::string item(const std::string& dims, const std::string& text, const std::string& more = "") {
  return "<DataItem Dimensions=\"" + dims + "\" Format=\"XML\" " + more + ">" + text + "</DataItem>\n";
}

const std::string triangle_mesh = "<Topology TopologyType=\"Triangle\" NumberOfElements=\"2\">" +
                                  item("2 3", "0 1 2 1 3 2", "NumberType=\"Int\"") + "</Topology>\n<Geometry GeometryType=\"XY\">" +
                                  item("4 2", "0 0 1 0 0 1 1 1", "Precision=\"8\"") + "</Geometry>\n";

std::string attribute(const std::string& name, const std::string& more, const std::string& data) {
  return "<Attribute Name=\"" + name + "\" " + more + ">" + data + "</Attribute>\n";
}

DatasetPtr read(const std::string& domain, const ReadOptions& options = {}) { return test::read_text("t.xdmf", file(domain), options); }

}  // namespace

TEST_CASE("xdmf: triangles with point, cell and grid attributes") {
  const DatasetPtr d = read(grid(triangle_mesh + attribute("s", "Center=\"Node\" AttributeType=\"Scalar\"", item("4", "1 2 3 4")) +
                                 attribute("v", "Center=\"Cell\" AttributeType=\"Vector\"", item("2 3", "1 2 3 4 5 6", "Precision=\"8\"")) +
                                 attribute("t", "Center=\"Grid\"", item("1", "7", "NumberType=\"Int\"")) + "<Time Value=\"1.5\"/>"));
  CHECK(d->point_count() == 4);
  CHECK(cell_type_counts(d->mesh()) == std::vector<std::pair<std::string_view, size_t>>{{"Triangle", 2}});
  CHECK(d->as<UnstructuredMesh>()->points.at(3) == Vec3{1, 1, 0});
  CHECK(d->fields().require("s").array.type() == ElementType::f32);
  CHECK(d->fields().require("v", Association::cell).array.get(1, 2) == 6);
  CHECK(d->fields().require("t", Association::whole).array.type() == ElementType::i32);
  CHECK(d->time() == 1.5);
  ReadOptions one;
  one.fields = {"v"};
  CHECK(read(grid(triangle_mesh + attribute("s", "", item("4", "no numbers here")) + attribute("v", "Center=\"Cell\"", item("2", "1 2"))),
             one)
            ->fields()
            .size() == 1);
}

TEST_CASE("xdmf: symmetric tensors become whole ones") {
  const DatasetPtr d =
      read(grid(triangle_mesh + attribute("t", "Center=\"Cell\" AttributeType=\"Tensor6\"", item("2 6", "1 2 3 4 5 6 0 0 0 0 0 0"))));
  const Field& t = d->fields().require("t");
  CHECK(t.components() == 9);
  const double want[9] = {1, 2, 3, 2, 4, 5, 3, 5, 6};
  for (int c = 0; c < 9; ++c) CHECK(t.array.get(0, c) == want[c]);
}

TEST_CASE("xdmf: a mixed topology holds all kinds of cells") {
  const DatasetPtr d = read(grid(
      "<Topology TopologyType=\"Mixed\" NumberOfElements=\"5\">" +
      item("35", "1 1 0  2 2 0 1  4 0 1 2  3 4 0 1 2 3  16 4 3 0 2 1 3 0 1 3 3 1 2 3 3 0 3 2", "NumberType=\"Int\"") +
      "</Topology><Geometry GeometryType=\"X_Y_Z\">" + item("4", "0 1 0 0") + item("4", "0 0 1 0") + item("4", "0 0 0 1") + "</Geometry>"));
  const auto* m = d->as<UnstructuredMesh>();
  REQUIRE(m);
  const CellType want[5] = {CellType::vertex, CellType::line, CellType::triangle, CellType::polygon, CellType::polyhedron};
  for (size_t i = 0; i < 5; ++i) CHECK(m->type(i) == want[i]);
  CHECK(cells_view(m->cells).size(4) == 4);
  CHECK(m->faces.size() == 4);
  CHECK(cells_view(m->faces).point(3, 2) == 2);
}

TEST_CASE("xdmf: every fixed topology is known by its name and its points") {
  const std::tuple<const char*, CellType> kinds[] = {{"Tetrahedron", CellType::tetra},
                                                     {"Pyramid", CellType::pyramid},
                                                     {"Wedge", CellType::wedge},
                                                     {"Hexahedron", CellType::hexahedron},
                                                     {"Quadrilateral", CellType::quad},
                                                     {"Edge_3", CellType::quadratic_edge},
                                                     {"Tri_6", CellType::quadratic_triangle},
                                                     {"Triangle_6", CellType::quadratic_triangle},
                                                     {"Quad_8", CellType::quadratic_quad},
                                                     {"Quadrilateral_9", CellType::biquadratic_quad},
                                                     {"Tet_10", CellType::quadratic_tetra},
                                                     {"Pyramid_13", CellType::quadratic_pyramid},
                                                     {"Wedge_15", CellType::quadratic_wedge},
                                                     {"Wedge_18", CellType::biquadratic_quadratic_wedge},
                                                     {"Hex_20", CellType::quadratic_hexahedron},
                                                     {"Hexahedron_24", CellType::biquadratic_quadratic_hexahedron},
                                                     {"HEX_27", CellType::triquadratic_hexahedron}};
  for (const auto& [name, type] : kinds) {
    CAPTURE(name);
    const int n = cell_type_info(type).points;
    std::string ids, xyz;
    for (int i = 0; i < n; ++i) ids += std::to_string(i) + " ", xyz += std::to_string(i) + " 0 0 ";
    const DatasetPtr d = read(
        grid(fmt::format("<Topology TopologyType=\"{}\">{}</Topology><Geometry GeometryType=\"XYZ\">{}</Geometry>", name,
                         item(fmt::format("1 {}", n), ids, "NumberType=\"UInt\" Precision=\"8\""), item(fmt::format("{} 3", n), xyz))));
    CHECK(d->cell_count() == 1);
    CHECK(d->as<UnstructuredMesh>()->type(0) == type);
  }
}

TEST_CASE("xdmf: vertices without a list, lines, polygons and a base offset") {
  const std::string points = "<Geometry GeometryType=\"XYZ\">" + item("4 3", "0 0 0 1 0 0 1 1 0 0 1 0") + "</Geometry>";
  CHECK(read(grid("<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"4\"/>" + points))->cell_count() == 4);
  const DatasetPtr lines = read(grid("<Topology TopologyType=\"Polyline\" NodesPerElement=\"2\" NumberOfElements=\"2\" BaseOffset=\"1\">" +
                                     item("4", "1 2 3 4", "NumberType=\"Int\"") + "</Topology>" + points));
  CHECK(lines->as<UnstructuredMesh>()->type(1) == CellType::line);
  CHECK(cells_view(lines->as<UnstructuredMesh>()->cells).point(1, 1) == 3);
  const DatasetPtr polygon = read(grid("<Topology TopologyType=\"Polygon\" NodesPerElement=\"4\">" +
                                       item("4", "0 1 2 3", "NumberType=\"Int\"") + "</Topology>" + points));
  CHECK(polygon->as<UnstructuredMesh>()->type(0) == CellType::polygon);
}

TEST_CASE("xdmf: grids count their dimensions slowest first") {
  const DatasetPtr u = read(grid("<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"2 3 4\"/><Geometry GeometryType=\"ORIGIN_DXDYDZ\">" +
                                 item("3", "10 20 30") + item("3", "1 2 3") + "</Geometry>" +
                                 attribute("c", "Center=\"Cell\"", item("1 2 3", "1 2 3 4 5 6"))));
  const auto* g = u->as<UniformGrid>();
  REQUIRE(g);
  CHECK(g->dims == std::array<size_t, 3>{4, 3, 2});
  CHECK(g->origin == Vec3{30, 20, 10});
  CHECK(g->spacing == Vec3{3, 2, 1});
  const DatasetPtr r = read(grid("<Topology TopologyType=\"2DRectMesh\" Dimensions=\"2 3\"/><Geometry GeometryType=\"VXVY\">" +
                                 item("3", "0 1 4") + item("2", "5 6") + "</Geometry>"));
  CHECK(r->as<RectilinearGrid>()->dims() == std::array<size_t, 3>{3, 2, 1});
  CHECK(r->bounds().hi.x == 4);
  const DatasetPtr s = read(grid("<Topology TopologyType=\"2DSMesh\" Dimensions=\"2 2\"/><Geometry GeometryType=\"XY\">" +
                                 item("4 2", "0 0 1 0 0 1 1 2") + "</Geometry>"));
  CHECK(s->as<CurvilinearGrid>()->points.at(3) == Vec3{1, 2, 0});
}

TEST_CASE("xdmf: binary data of either byte order, from any byte on") {
  const std::string bytes = std::string("xyz") + std::string("\x3f\x80\0\0\x40\0\0\0", 8) + std::string("\0\0\x80\x3f", 4);
  test::temp_file("t.bin", bytes);
  auto with = [&](const char* more, const char* dims) {
    return grid(triangle_mesh + attribute("b", "Center=\"Grid\" AttributeType=\"Scalar\"",
                                          fmt::format("<DataItem Format=\"Binary\" Dimensions=\"{}\" {}>t.bin</DataItem>", dims, more)));
  };
  const Field big = read(with("Endian=\"Big\" Seek=\"3\"", "2"))->fields().require("b");
  CHECK(big.array.get(0) == 1);
  CHECK(big.array.get(1) == 2);
  CHECK(read(with("Endian=\"Little\" Seek=\"11\"", "1"))->fields().require("b").array.get(0) == 1);
  CHECK(contains(refusal("t.xdmf", file(with("Seek=\"3\"", "4"))), "needs 16 bytes from byte 3 on, but 't.bin' has 15"));
  CHECK(contains(refusal("t.xdmf", file(with("Seek=\"3\"", "4611686018427387904"))), "too many numbers to count"));
  CHECK(contains(refusal("t.xdmf", file(with("Compression=\"Zlib\"", "1"))), "packed with 'Zlib'"));
}

TEST_CASE("xdmf: hyperslabs and functions") {
  const std::string slab = "<DataItem ItemType=\"HyperSlab\" Dimensions=\"4\">" + item("3 2", "0 1 1 2 2 2", "NumberType=\"Int\"") +
                           item("2 4", "0 1 2 3 4 5 6 7") + "</DataItem>";
  const DatasetPtr d = read(grid(triangle_mesh + attribute("h", "", slab) +
                                 attribute("f", "",
                                           "<DataItem ItemType=\"Function\" Function=\"2 * ($0 + 1) / $1\" Dimensions=\"4\">" +
                                               item("4", "0 1 2 3") + item("4", "1 2 1 2") + "</DataItem>") +
                                 attribute("j", "AttributeType=\"Vector\"",
                                           "<DataItem ItemType=\"Function\" Function=\"JOIN($0, -$0, SQRT($1))\" Dimensions=\"4 3\">" +
                                               item("4", "0 1 2 3") + item("4", "1 4 9 16") + "</DataItem>")));
  const double h[4] = {1, 3, 5, 7}, f[4] = {2, 2, 6, 4};
  for (size_t i = 0; i < 4; ++i) {
    CHECK(d->fields().require("h").array.get(i) == h[i]);
    CHECK(d->fields().require("f").array.get(i) == f[i]);
    CHECK(d->fields().require("j").array.get(i, 1) == -double(i));
    CHECK(d->fields().require("j").array.get(i, 2) == double(i + 1));
  }
  const auto wrong = [&](const char* function) {
    return refusal(
        "t.xdmf",
        file(grid(triangle_mesh + attribute("f", "",
                                            fmt::format("<DataItem ItemType=\"Function\" Function=\"{}\" Dimensions=\"4\">", function) +
                                                item("4", "0 1 2 3") + "</DataItem>"))));
  };
  CHECK(contains(wrong("$1"), "names an argument that does not exist"));
  CHECK(contains(wrong("WHERE($0)"), "calls 'where'"));
  CHECK(contains(wrong(std::string(500, '(').c_str()), "nested too deep"));
  CHECK(contains(refusal("t.xdmf", file(grid(triangle_mesh + attribute("h", "",
                                                                       "<DataItem ItemType=\"HyperSlab\" Dimensions=\"4\">" +
                                                                           item("3 2", "0 1 1 2 2 9", "NumberType=\"Int\"") +
                                                                           item("2 4", "0 1 2 3 4 5 6 7") + "</DataItem>")))),
                 "selects up to index"));
}

TEST_CASE("xdmf: a series loads the step that is asked for; borrowed meshes are no data of their own") {
  std::string steps = "<Grid Name=\"series\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (int i = 0; i < 3; ++i)
    steps += "<Grid Name=\"s\"><xi:include xpointer=\"xpointer(//Grid[@Name=&quot;mesh&quot;]/*[self::Topology or self::Geometry])\"/>" +
             fmt::format("<Time Value=\"{}\"/>", i * 0.5) + attribute("p", "", item("4", fmt::format("{0} {0} {0} {0}", i))) + "</Grid>\n";
  const std::string text = file(steps + "</Grid>\n" + grid(triangle_mesh, "mesh"));
  const std::string path = test::temp_file("series.xdmf", text);
  Context context;
  CHECK(file_times(path, {}, context) == std::vector<double>{0, 0.5, 1});
  ReadOptions o;
  o.time = 0.6;
  const DatasetPtr d = test::read_file(path, o);
  CHECK(d->time() == 0.5);
  CHECK(d->cell_count() == 2);
  CHECK(d->fields().require("p").array.get(0) == 1);
  o.time.reset(), o.step = 3;
  CHECK(contains(test::error_of([&] { test::read_file(path, o); }), "there is no time step 3"));
}

TEST_CASE("xdmf: times of a series may stand in a list; spatial collections have named parts") {
  const std::string series = "<Grid GridType=\"Collection\" CollectionType=\"Temporal\"><Time TimeType=\"List\">" + item("2", "3 4") +
                             "</Time>" + grid(triangle_mesh) +
                             grid(
                                 "<Topology Reference=\"XML\">/Xdmf/Domain/Grid/Grid[1]/Topology</Topology><Geometry "
                                 "Reference=\"/Xdmf/Domain/Grid/Grid[1]/Geometry\"/>") +
                             "</Grid>";
  Context context;
  const std::string path = test::temp_file("list.xdmf", file(series));
  CHECK(file_times(path, {}, context) == std::vector<double>{3, 4});
  ReadOptions o;
  o.step = 1;
  CHECK(test::read_file(path, o)->cell_count() == 2);
  const std::string parts = test::temp_file("parts.xdmf", file("<Grid GridType=\"Collection\" CollectionType=\"Spatial\">" +
                                                               grid(triangle_mesh, "a") + grid(triangle_mesh, "b") + "</Grid>"));
  const auto c = std::get<CollectionPtr>(read_data(parts, {}, context));
  REQUIRE(c->parts.size() == 2);
  CHECK(c->parts[1].name == "b");
}

TEST_CASE("xdmf: faults are named with their line") {
  CHECK(contains(refusal("t.xdmf", "<Xdmf><Domain><Grid>"), "is not well-formed XML"));
  CHECK(contains(refusal("t.xdmf", file("")), "has no Grid"));
  CHECK(contains(refusal("t.xdmf", file(grid("<Topology TopologyType=\"Triangle\"/>"))), "has no Geometry"));
  const std::string message = refusal("t.xdmf", file(grid(triangle_mesh + attribute("s", "Center=\"Node\"", item("3", "1 2 3")))));
  CHECK(contains(message, "has 3 numbers for 4 points"));
  CHECK(contains(message, "line 9"));
  CHECK(contains(refusal("t.xdmf", file(grid(triangle_mesh + attribute("s", "", item("4", "1 2"))))), "has 3 characters for 4 numbers"));
  CHECK(contains(refusal("t.xdmf", file(grid(triangle_mesh + attribute("s", "", item("4", "1 2 x 4"))))), "t.xdmf"));
  CHECK(
      contains(refusal("t.xdmf", file(grid("<Topology Reference=\"/Xdmf/Domain/Grid/Topology\"/>" + triangle_mesh))), "refers to itself"));
  CHECK(contains(
      refusal("t.xdmf", file(grid("<Topology TopologyType=\"Mixed\" NumberOfElements=\"1\">" + item("3", "99 0 1", "NumberType=\"Int\"") +
                                  "</Topology><Geometry>" + item("1 3", "0 0 0") + "</Geometry>"))),
      "unknown kind 99"));
  CHECK(contains(refusal("t.xdmf", file(grid("<Topology TopologyType=\"Triangle\">" + item("3", "0 1 9", "NumberType=\"Int\"") +
                                             "</Topology><Geometry>" + item("3 3", "0 0 0 1 0 0 0 1 0") + "</Geometry>"))),
                 "point id 9"));
  CHECK(contains(refusal("t.xdmf", file(grid(triangle_mesh +
                                             attribute("s", "", "<DataItem Format=\"HDF\" Dimensions=\"4\">nothing.h5:/a</DataItem>")))),
                 "nothing.h5"));
}

TEST_CASE("xdmf: cut and damaged files are read or refused") {
  const std::string text =
      file(grid(triangle_mesh + attribute("s", "Center=\"Node\" AttributeType=\"Scalar\"", item("4", "1 2 3 4")) +
                attribute("h", "",
                          "<DataItem ItemType=\"HyperSlab\" Dimensions=\"4\">" + item("3 1", "0 1 4", "NumberType=\"Int\"") +
                              item("8", "0 1 2 3 4 5 6 7") + "</DataItem>")));
  CHECK(test::cut_and_damage("damaged.xdmf", text) >= 62);
}
