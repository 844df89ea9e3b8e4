// SPDX-License-Identifier: Apache-2.0
// AVS UCD, Tecplot ASCII, GAMBIT neutral and nek5000.
#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "io/mesh/total_measure.h"
#include "mesh_robust.h"

using namespace sg;
using test::put_bytes;

namespace {

// A cube, a pyramid on it and a prism beside it; UCD lists tops first.
const std::string ucd =
    "# comment\n11 3 3 1 0\n"
    "10 0 0 0\n11 1 0 0\n12 1 1 0\n13 0 1 0\n14 0 0 1\n15 1 0 1\n16 1 1 1\n17 0 1 1\n18 0.5 0.5 2\n19 2 0 0\n20 2 0 1\n"
    "1 7 hex 14 15 16 17 10 11 12 13\n2 8 pyr 18 14 15 16 17\n3 9 prism 15 20 16 11 19 12\n"
    "2 1 2\nT, K\nflow, m/s\n10 1 2 3\n11 2 2 3\n12 3 2 3\n13 4 2 3\n14 5 2 3\n15 6 2 3\n16 7 2 3\n17 8 2 3\n18 9 2 3\n19 10 2 3\n20 11 2 "
    "3\n"
    "1 1\nq\n1 0.5\n3 1.5\n2 2.5\n";

const std::string tecplot =
    "TITLE = \"a, b\"\nVARIABLES = \"X [m]\" \"Y\"\n \"T\", q\n# comment\n"
    "ZONE T=\"grid\", I=3, J=2, F=BLOCK, VARLOCATION=([4]=CELLCENTERED), DT=(SINGLE SINGLE DOUBLE SINGLE)\n"
    "0 1 2 0 1 2\n3*0 3*1.0\n1 2 3 4 5 6.125\n10 20\n"
    "TEXT X=1, Y=2, T=\"ZONE of text\"\nZONE N=4, E=2, ET=TRIANGLE, F=FEPOINT, T=\"tri\"\n"
    "0 0 1 5\n1 0 2 5\n1 1 3 5\n0 1 4 5\n1 2 3\n1 3 4\n"
    "ZONE T=\"shared\", NODES=4, ELEMENTS=2, ZONETYPE=FETRIANGLE, DATAPACKING=BLOCK, VARSHARELIST=([1,2]=2), CONNECTIVITYSHAREZONE=2\n"
    "9 8 7 6\n1 2 3 4\n";

const std::string gambit =
    "        CONTROL INFO 2.4.6\n** GAMBIT NEUTRAL FILE\na title\nPROGRAM: Gambit VERSION: 2.4.6\n date\n"
    "     NUMNP     NELEM     NGRPS    NBSETS     NDFCD     NDFVL\n 9 2 1 2 3 3\nENDOFSECTION\n"
    "   NODAL COORDINATES 2.4.6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 1 1 0\n5 0 0 1\n6 1 0 1\n7 0 1 1\n8 1 1 1\n9 .5 .5 2\nENDOFSECTION\n"
    "      ELEMENTS/CELLS 2.4.6\n 1 4 8 1 2 3 4 5 6 7\n 8\n 2 7 5 5 6 7 8 9\nENDOFSECTION\n"
    "       ELEMENT GROUP 2.4.6\nGROUP: 1 ELEMENTS: 1 MATERIAL: 6 NFLAGS: 1\nfluid\n0\n2\nENDOFSECTION\n"
    " BOUNDARY CONDITIONS 2.4.6\n wall 1 1 0 6\n 1 4 2\nENDOFSECTION\n BOUNDARY CONDITIONS 2.4.6\n apex 0 1 0 24\n 9\nENDOFSECTION\n";

// One element of 3 x 2 (x 2) points: x = i, y = j, z = k; a velocity (x, 2, 3) and a pressure.
std::string nek(bool solid, int word, bool big_endian, bool positions, double time) {
  std::string s = fmt::format("#std {} 3 2 {} 1 1 {:.7e} 7 0 1 {}UP", word, solid ? 2 : 1, time, positions ? "X" : "");
  s.resize(132, ' ');
  put_bytes<float>(s, 6.54321f, big_endian);
  put_bytes<int32_t>(s, 42, big_endian);
  const int nk = solid ? 2 : 1, components = solid ? 3 : 2;
  auto block = [&](auto value) {
    for (int k = 0; k < nk; ++k)
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 3; ++i)
          word == 4 ? put_bytes<float>(s, float(value(i, j, k)), big_endian) : put_bytes<double>(s, value(i, j, k), big_endian);
  };
  for (int c = 0; c < components && positions; ++c) block([&](int i, int j, int k) { return double(c == 0 ? i : c == 1 ? j : k); });
  for (int c = 0; c < components; ++c) block([&](int i, int, int) { return double(c == 0 ? i : c + 1); });
  block([&](int i, int j, int) { return i + 10 * j + time; });
  return s;
}

}  // namespace

TEST_CASE("ucd: cells of every kind are turned right side up, fields have units") {
  const DatasetPtr d = test::read_text("a.inp", ucd);
  CHECK(cell_type_counts(d->mesh()) == std::vector<std::pair<std::string_view, size_t>>{{"Hexahedron", 1}, {"Wedge", 1}, {"Pyramid", 1}});
  CHECK(test::total_measure(d) == doctest::Approx(1 + 1.0 / 3 + 0.5));
  CHECK(d->fields().require("T").unit == "K");
  CHECK(d->fields().require("T").array.get(8) == 9);
  CHECK(d->fields().require("flow").array.get(8, 1) == 3);
  CHECK(d->fields().require("q").array.get(1) == 2.5);
  CHECK(d->fields().require("Material Id").array.get(2) == 9);
}

TEST_CASE("ucd: binary files in both byte orders") {
  for (bool big : {false, true}) {
    std::string s(1, '\7');
    for (int32_t n : {3, 1, 0, 1, 0, 3}) put_bytes(s, n, big);
    for (int32_t n : {1, 5, 3, 2, 3, 2, 1}) put_bytes(s, n, big);
    for (float v : {0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 7.f, 7.f, 7.f}) put_bytes(s, v, big);
    std::string labels = "heat";
    labels.resize(1024, '\0');
    std::string units = "W";
    units.resize(1024, '\0');
    s += labels + units;
    for (int32_t n : {1, 1}) put_bytes(s, n, big);
    for (float v : {0.f, 9.f, 4.f}) put_bytes(s, v, big);
    put_bytes<int32_t>(s, 1, big);
    const DatasetPtr d = test::read_text("b.inp", s);
    CHECK(d->as<UnstructuredMesh>()->points.at(1) == Vec3(1, 0, 7));
    CHECK(cells_view(d->as<UnstructuredMesh>()->cells).point(0, 0) == 2);
    CHECK(d->fields().require("heat").array.get(0) == 4);
    CHECK(d->fields().require("heat").unit == "W");
    if (!big) test::check_survives("robust.inp", s);
  }
}

TEST_CASE("ucd: what is wrong is named with its line; damaged files are refused") {
  auto message = [](std::string s, std::string_view from, std::string_view to) {
    s.replace(s.find(from), from.size(), to);
    return test::error_of([&] { test::read_bytes("w.inp", s); });
  };
  CHECK(message(ucd, "hex 14", "hex 99").find("line 14: node 99") != std::string::npos);
  CHECK(message(ucd, "2 8 pyr", "2 8 cone").find("'cone'") != std::string::npos);
  CHECK(message(ucd, "2 1 2\nT", "2 1 3\nT").find("announces 3") != std::string::npos);
  test::check_survives("robust.inp", ucd);
  test::check_survives_sizes("robust.inp", ucd);
}

TEST_CASE("tecplot: zones of both kinds, values at cells, repeats, shared variables") {
  const Data data = test::read_bytes("a.tec", tecplot);
  const auto& parts = std::get<CollectionPtr>(data)->parts;
  REQUIRE(parts.size() == 3);
  CHECK(parts[0].name == "grid");
  const DatasetPtr grid = std::get<DatasetPtr>(parts[0].data), tri = std::get<DatasetPtr>(parts[1].data),
                   shared = std::get<DatasetPtr>(parts[2].data);
  CHECK(grid->as<CurvilinearGrid>()->dims == std::array<size_t, 3>{3, 2, 1});
  CHECK(grid->as<CurvilinearGrid>()->points.at(5) == Vec3(2, 1, 0));
  CHECK(grid->fields().require("T").array.type() == ElementType::f64);
  CHECK(grid->fields().require("T").array.get(5) == 6.125);
  CHECK(grid->fields().require("q", Association::cell).array.get(1) == 20);
  CHECK(grid->notes()[0].second == "a, b");
  CHECK(tri->cell_count() == 2);
  CHECK(tri->fields().require("T").array.type() == ElementType::f32);
  CHECK(shared->as<UnstructuredMesh>()->points.at(2) == Vec3(1, 1, 0));
  CHECK(shared->fields().require("T").array.get(0) == 9);
  CHECK(shared->cell_count() == 2);
}

TEST_CASE("tecplot: zones of different times are steps") {
  const std::string s = "VARIABLES = X, Y, T\nZONE I=2, SOLUTIONTIME=0.5\n0 0 1\n1 0 2\nZONE I=2, SOLUTIONTIME=1.5\n0 0 3\n1 0 4\n";
  Context context;
  ReadOptions o;
  o.time = 1.4;
  const DatasetPtr d = test::read_text("t.dat", s, o);
  CHECK(d->time() == 1.5);
  CHECK(d->fields().require("T").array.get(1) == 4);
  CHECK(file_times(test::temp_folder() + "t.dat", {}, context) == std::vector<double>{0.5, 1.5});
}

TEST_CASE("tecplot: what is wrong is named with its line; damaged files are refused") {
  auto message = [](std::string s, std::string_view from, std::string_view to) {
    s.replace(s.find(from), from.size(), to);
    return test::error_of([&] { test::read_bytes("w.tec", s); });
  };
  CHECK(message(tecplot, "1 3 4\n", "1 3 5\n").find("line 17: node 5") != std::string::npos);
  CHECK(message(tecplot, "ET=TRIANGLE", "ET=POLYGON").find("FEPOLYGON") != std::string::npos);
  CHECK(message(tecplot, "10 20\n", "10 5*20\n").find("repeat count") != std::string::npos);
  CHECK(message(tecplot, "I=3, J=2", "I=2147483648, J=2147483648").find("only") != std::string::npos);
  CHECK(message(tecplot, "3*0 3*1.0", "3*0 2*1 x").find("'x'") != std::string::npos);
  test::check_survives("robust.tec", tecplot);
  test::check_survives_sizes("robust.tec", tecplot);
}

TEST_CASE("gambit: bricks and pyramids run x fastest; groups and node sets become fields") {
  const DatasetPtr d = test::read_text("a.neu", gambit);
  CHECK(test::total_measure(d) == doctest::Approx(1 + 1.0 / 3));
  CHECK(d->fields().require("Material Type").array.get(0) == 0);
  CHECK(d->fields().require("Material Type").array.get(1) == 6);
  CHECK(d->fields().require("Boundary Condition").array.get(8) == 2);
  CHECK(d->fields().require("Boundary Condition").array.get(0) == 0);
  std::string s = gambit;
  s.replace(s.find(" 2 7 5 5"), 8, " 2 7 4 5");
  CHECK(test::error_of([&] { test::read_bytes("w.neu", s); }).find("type 7 with 4 nodes") != std::string::npos);
  test::check_survives("robust.neu", gambit);
  test::check_survives_sizes("robust.neu", gambit);
}

TEST_CASE("nek5000: elements become linear cells between their own points, in every word size and byte order") {
  for (int word : {4, 8})
    for (bool big : {false, true})
      for (bool solid : {false, true}) {
        const DatasetPtr d = test::read_text("one.fld", nek(solid, word, big, true, 0.25));
        CHECK(d->point_count() == (solid ? 12 : 6));
        CHECK(d->cell_count() == 2);
        CHECK(test::total_measure(d) == doctest::Approx(2));
        CHECK(d->time() == 0.25);
        CHECK(d->fields().require("velocity").array.get(2, 0) == 2);
        CHECK(d->fields().require("velocity").array.get(2, 2) == (solid ? 3 : 0));
        CHECK(d->fields().require("pressure").array.get(4) == doctest::Approx(11.25));
        CHECK(d->fields().require("pressure").array.type() == (word == 4 ? ElementType::f32 : ElementType::f64));
        CHECK(d->fields().require("element").array.get(1) == 42);
      }
}

TEST_CASE("nek5000: steps by their template; a step without positions takes the first one's") {
  Context context;
  write_file(test::temp_folder() + "flow0.f00003", nek(false, 4, false, true, 0.5));
  write_file(test::temp_folder() + "flow0.f00004", nek(false, 4, false, false, 0.75));
  const std::string s = "filetemplate: flow%01d.f%05d\nfirsttimestep: 3\nnumtimesteps: 2\n";
  ReadOptions o;
  o.step = 1;
  const DatasetPtr d = test::read_text("flow.nek5000", s, o);
  CHECK(d->time() == 0.75);
  CHECK(d->bounds().hi == Vec3(2, 1, 0));
  CHECK(d->fields().require("pressure").array.get(0) == 0.75);
  CHECK(file_times(test::temp_folder() + "flow.nek5000", {}, context) == std::vector<double>{0.5, 0.75});
  CHECK(test::error_of([&] {
          test::read_bytes("flow.nek5000", "filetemplate: flow%01d.f%05d\nfirsttimestep: 9\nnumtimesteps: 1\n");
        }).find("f00009") != std::string::npos);
  CHECK(test::error_of([&] { test::read_bytes("alone.fld", nek(false, 4, false, false, 1)); }).find("no positions") != std::string::npos);
  std::string huge = nek(false, 4, false, true, 0);
  huge.replace(huge.find("1 1 0.0"), 1, "9");
  CHECK(test::error_of([&] { test::read_bytes("huge.fld", huge); }).find("the file ends") != std::string::npos);
  test::check_survives("robust.fld", nek(true, 4, false, true, 0));
}
