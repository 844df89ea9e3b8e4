// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "data/cells/shape/cell_map.h"
#include "io/io_files.h"
#include "io/mesh/mesh_robust.h"

using namespace sg;

namespace {

// Control points at (i/3, j/3, z) make the identity; the second patch is bilinear.
std::string patches() {
  std::string s = "2\n3 3\n";
  for (int i = 0; i <= 3; ++i)
    for (int j = 0; j <= 3; ++j) s += fmt::format("{} {} {}\n", i / 3.0, j / 3.0, i == 1 && j == 1 ? 9 : 0);
  return s + "1 1\n0 0 5\n0 1 5\n1 0 5\n1 1 6\n";
}

const std::string graph =
    "Creator \"us\"\ngraph [\n  comment \"two \n lines\" directed 1\n  node_data size float\n"
    "  node [ id 1 label \"a &amp; b\" graphics [ x 0.5 y 2 ] ]\n  node [ id 7 label \"c\" ] # end\n  edge [ source 1 target 7 weight 2.5 "
    "]\n]\n";

}  // namespace

TEST_CASE("bpt: control points lie where the polynomial says") {
  const DatasetPtr d = test::read_text("a.bpt", patches());
  CHECK(d->cell_count() == 2);
  CHECK(d->point_count() == 20);
  CHECK(d->as<UnstructuredMesh>()->type(1) == CellType::bezier_quad);
  CellMap map(d);
  map.open(0);
  // The inner control point (1, 1) has the weight 9 u (1-u)^2 v (1-v)^2; the file's columns are the first axis.
  const double u = 0.3, v = 0.6;
  const Vec3 p = map.position({v, u, 0});
  CHECK(std::abs(p.x - u) < 1e-12);
  CHECK(std::abs(p.y - v) < 1e-12);
  CHECK(std::abs(p.z - 9 * 9 * u * (1 - u) * (1 - u) * v * (1 - v) * (1 - v)) < 1e-12);
  map.open(1);
  CHECK(length(map.position({0.5, 0.5, 0}) - Vec3(0.5, 0.5, 5.25)) < 1e-12);
}

TEST_CASE("bpt: what is wrong is named with its line, and damaged files are read or refused") {
  using test::contains;
  CHECK(contains(test::refusal("b.bpt", "1\n3 11\n0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"), "degree 11"));
  CHECK(contains(test::refusal("b.bpt", "1\n0 3\n0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"), "degree 0"));
  CHECK(contains(test::refusal("b.bpt", "4000000000\n3 3\n"), "line 1"));
  CHECK(contains(test::refusal("b.bpt", "1\n1 1\n0 0 0 1 0 0 0 1 0 1 1 x 0 0 0 0 0\n"), "'x'"));
  CHECK(contains(test::refusal("b.bpt", "1\n1 1\n0 0 0 1 0 0 0 1 0 1 1 inf 0 0 0 0\n"), "finite"));
  test::check_survives("robust.bpt", patches());
}

TEST_CASE("bpt: the teapot has 32 patches of degree 3" * doctest::skip(test::no_data())) {
  const DatasetPtr d = test::read_file(test::data_file("surfaces/teapot.bpt"));
  CHECK(d->cell_count() == 32);
  CHECK(d->point_count() == 512);
  CHECK(d->bounds().lo == Vec3(-3, -2, 0));
  CHECK(d->bounds().hi == Vec3(3.525, 2, 3.15));
}

TEST_CASE("gml: nodes and edges are tables, nested keys are joined") {
  const Data data = test::read_bytes("a.gml", graph);
  const auto& parts = std::get<CollectionPtr>(data)->parts;
  REQUIRE(parts.size() == 2);
  CHECK(parts[0].name == "nodes");
  CHECK(parts[1].name == "edges");
  const Table& nodes = *std::get<TablePtr>(parts[0].data);
  REQUIRE(nodes.columns.size() == 4);
  CHECK(nodes.columns[0].array.get(1) == 7);
  CHECK(nodes.words(1)->at(0) == "a & b");
  CHECK(nodes.columns[2].name == "graphics.x");
  CHECK(std::isnan(nodes.columns[2].array.get(1)));
  CHECK(std::get<TablePtr>(parts[1].data)->columns[2].array.get(0) == 2.5);
}

TEST_CASE("gml: what is wrong is named with its line, and damaged files are read or refused") {
  using test::contains;
  auto message = [](const std::string& s) { return test::error_of([&] { test::read_bytes("b.gml", s); }); };
  CHECK(contains(message("graph [\n node [ id 1\n"), "line 3: a list has no end"));
  CHECK(contains(message("graph [\n node [ id ] ]"), "line 2: 'id' has no value"));
  CHECK(contains(message("graph [ label \"x ]"), "has no end"));
  CHECK(contains(message("tree [ id 1 ]"), "no 'graph"));
  CHECK(contains(message("graph [ directed 1 ]"), "neither nodes nor edges"));
  std::string deep = "graph [ node [ ";
  for (int i = 0; i < 100; ++i) deep += "a [ ";
  CHECK(contains(message(deep), "nested"));
  std::string wide = "graph [\n";
  for (int i = 0; i < 6000; ++i) wide += fmt::format("node [ k{} 1 ]\n", i);
  CHECK(contains(message(wide), "columns"));
  test::check_survives("robust.gml", graph);
}

TEST_CASE("gml: the graph of the data folder has 115 nodes and 228 edges" * doctest::skip(test::no_data())) {
  Context context;
  const Data data = read_data(test::data_file("tables/fsm.gml"), {}, context);
  const auto& parts = std::get<CollectionPtr>(data)->parts;
  REQUIRE(parts.size() == 2);
  const Table &nodes = *std::get<TablePtr>(parts[0].data), &edges = *std::get<TablePtr>(parts[1].data);
  CHECK(nodes.columns[0].array.count() == 115);
  CHECK(edges.columns[0].array.count() == 228);
  CHECK(nodes.columns.size() == 4);
  CHECK(nodes.words(3)->size() == 115);
}
