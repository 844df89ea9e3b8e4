// SPDX-License-Identifier: Apache-2.0
// EnSight Gold: one model written in all five forms, time in files and in one file, and bad input.
#include <fmt/core.h>

#include <cmath>

#include "base/bytes.h"
#include "case_files.h"
#include "data/cells/cell_topology.h"

using namespace sg;
using namespace sg::test;

namespace {

enum class Writing { ascii, c_little, c_big, fortran_little, fortran_big };
constexpr Writing all_forms[] = {Writing::ascii, Writing::c_little, Writing::c_big, Writing::fortran_little, Writing::fortran_big};

/// Writes lines and numbers in one of the forms.
struct Emit {
  Writing form;
  std::string out{};

  bool big() const { return form == Writing::c_big || form == Writing::fortran_big; }
  bool fortran() const { return form == Writing::fortran_little || form == Writing::fortran_big; }
  void item(const std::string& bytes) {
    if (fortran()) put_bytes(out, uint32_t(bytes.size()), big());
    out += bytes;
    if (fortran()) put_bytes(out, uint32_t(bytes.size()), big());
  }
  void head() {
    if (form != Writing::ascii) line(fortran() ? "Fortran Binary" : "C Binary");
  }
  void line(const std::string& text) {
    if (form == Writing::ascii) out += text + "\n";
    else item(text + std::string(80 - text.size(), ' '));
  }
  void ints(const std::vector<int>& v, size_t per_line = 1) {
    std::string s;
    for (size_t i = 0; i < v.size(); ++i)
      if (form == Writing::ascii) s += fmt::format("{:10}", v[i]) + ((i + 1) % per_line == 0 || i + 1 == v.size() ? "\n" : "");
      else put_bytes(s, int32_t(v[i]), big());
    if (form == Writing::ascii) out += s;
    else item(s);
  }
  void reals(const std::vector<float>& v) {
    std::string s;
    for (const float x : v)
      if (form == Writing::ascii) s += fmt::format("{:12.5e}\n", x);
      else put_bytes(s, x, big());
    if (form == Writing::ascii) out += s;
    else item(s);
  }
};

const std::vector<float> xs{0, 1, 1, 0, 0, 1, 1, 0, 2, 2}, ys{0, 0, 1, 1, 0, 0, 1, 1, 0, 1}, zs{0, 0, 0, 0, 1, 1, 1, 1, 0, 0};

// Part 1: a cube in several ways; part 2: a bent block with a hole; part 3: a rectilinear one; part 4: a range of a uniform one.
std::string geometry(Writing form, float shift = 0, bool with_head = true) {
  Emit e{form};
  if (with_head) e.head();
  e.line("one model");
  e.line("in all forms");
  e.line("node id given");
  e.line("element id ignore");
  e.line("part");
  e.ints({1});
  e.line("cells");
  e.line("coordinates");
  e.ints({10});
  e.ints({11, 12, 13, 14, 15, 16, 17, 18, 19, 20});
  std::vector<float> x = xs;
  for (float& v : x) v += shift;
  e.reals(x), e.reals(ys), e.reals(zs);
  e.line("hexa8");
  e.ints({1});
  e.ints({100});
  e.ints({1, 2, 3, 4, 5, 6, 7, 8}, 8);
  e.line("bar3");
  e.ints({1});
  e.ints({101});
  e.ints({1, 2, 9}, 3);
  e.line("nsided");
  e.ints({2});
  e.ints({102, 103});
  e.ints({3, 5});
  e.ints({1, 2, 3, 1, 2, 9, 10, 3}, 8);
  e.line("nfaced");
  e.ints({1});
  e.ints({104});
  e.ints({6});
  e.ints({4, 4, 4, 4, 4, 4});
  e.ints({4, 3, 2, 1, 5, 6, 7, 8, 1, 2, 6, 5, 2, 3, 7, 6, 3, 4, 8, 7, 4, 1, 5, 8}, 4);
  e.line("g_tria3");
  e.ints({1});
  e.ints({105});
  e.ints({1, 2, 3}, 3);

  e.line("part");
  e.ints({2});
  e.line("bent");
  e.line("block iblanked");
  e.ints({3, 2, 1}, 3);
  e.reals({0, 1, 2, 0, 1, 2}), e.reals({0, 0, 0, 1, 1.5f, 1}), e.reals({0, 0, 0, 0, 0, 0});
  e.ints({1, 1, 0, 1, 1, 1});
  e.line("part");
  e.ints({3});
  e.line("axes");
  e.line("block rectilinear");
  e.ints({2, 3, 2}, 3);
  e.reals({0, 4}), e.reals({0, 1, 5}), e.reals({-1, 1});
  e.line("part");
  e.ints({4});
  e.line("even");
  e.line("block uniform range");
  e.ints({9, 9, 9}, 3);
  e.ints({3, 4, 1, 2, 2, 2}, 6);
  e.reals({10, 20, 30, 0.5f, 0.25f, 2});
  return e.out;
}

std::string node_scalars(Writing form) {
  Emit e{form};
  e.line("pressure");
  e.line("part");
  e.ints({1});
  e.line("coordinates undef");
  e.reals({-999});
  e.reals({0, 1, 2, -999, 4, 5, 6, 7, 8, -999});
  e.line("part");
  e.ints({2});
  e.line("block partial");
  e.ints({2});
  e.ints({6, 1});
  e.reals({60, 10});
  return e.out;
}

std::string cell_vectors(Writing form) {
  Emit e{form};
  e.line("velocity");
  e.line("part");
  e.ints({1});
  e.line("nsided");  // not in the order of the geometry
  e.reals({1, 2}), e.reals({3, 4}), e.reals({5, 6});
  e.line("hexa8");
  e.reals({7}), e.reals({8}), e.reals({9});
  e.line("part");
  e.ints({3});
  e.line("block");
  e.reals({1, 2}), e.reals({0, 0}), e.reals({-1, -2});
  return e.out;
}

std::string node_tensors(Writing form, int components) {
  Emit e{form};
  e.line("stress");
  e.line("part");
  e.ints({4});
  e.line("block");
  for (int c = 0; c < components; ++c) e.reals(std::vector<float>(4, float(c)));
  return e.out;
}

const char* const case_text =
    "# a case\nFORMAT\ntype:   ensight gold\n\nGEOMETRY\nmodel: m.geo\nVARIABLE\n"
    "scalar per node: pressure m.scl\nvector per element: velocity m.vel\ntensor symm per node: stress m.ten\n"
    "tensor asym per node: strain m.asy\nconstant per case: gamma 1.4\n";

CaseFiles model(Writing form) {
  return {{"m.case", case_text},         {"m.geo", geometry(form)},        {"m.scl", node_scalars(form)},
          {"m.vel", cell_vectors(form)}, {"m.ten", node_tensors(form, 6)}, {"m.asy", node_tensors(form, 9)}};
}

}  // namespace

TEST_CASE("ensight: one model has the same parts and values in all five forms") {
  for (const Writing form : all_forms) {
    CAPTURE(int(form));
    const Data data = read_any(write_case("ens" + std::to_string(int(form)), model(form)) + "m.case");
    const auto all = leaves(data);
    REQUIRE(all.size() == 4);
    CHECK(all[0].first == "cells");
    CHECK(all[3].first == "even");

    const Dataset& cells = *all[0].second;
    const auto* mesh = cells.as<UnstructuredMesh>();
    REQUIRE(mesh);
    CHECK(cells.point_count() == 10);
    REQUIRE(cells.cell_count() == 6);
    CHECK(mesh->type(0) == CellType::hexahedron);
    CHECK(mesh->type(1) == CellType::quadratic_edge);
    CHECK(mesh->type(4) == CellType::polyhedron);
    const CellsView v = cells_view(mesh->cells);
    CHECK(v.point(1, 1) == 8);  // the middle node is EnSight's second, our third
    CHECK(v.point(1, 2) == 1);
    CHECK(v.size(3) == 5);
    CHECK(v.size(4) == 8);
    CHECK(mesh->polyhedron_faces.get(5) - mesh->polyhedron_faces.get(4) == 6);
    CHECK(cells.cell_ghost().get(5) == ghost_duplicate);
    CHECK(cells.cell_ghost().get(0) == 0);
    CHECK(cells.bounds().hi.x == 2);

    const Field& p = cells.fields().require("pressure", Association::point);
    CHECK(p.array.get(8) == 8);
    CHECK(std::isnan(p.array.get(3)));
    CHECK(cells.stats(p).nan == 2);
    const Field& u = cells.fields().require("velocity", Association::cell);
    CHECK(u.array.get(0, 2) == 9);
    CHECK(u.array.get(2, 0) == 1);
    CHECK(u.array.get(3, 1) == 4);
    CHECK(std::isnan(u.array.get(1, 0)));  // the file has nothing for bar3
    CHECK(cells.fields().require("gamma", Association::whole).array.get(0) == 1.4);

    const Dataset& bent = *all[1].second;
    REQUIRE(bent.as<CurvilinearGrid>());
    CHECK(bent.point_ghost().get(2) == ghost_hidden_point);
    CHECK(bent.cell_ghost().get(0) == 0);
    CHECK(bent.cell_ghost().get(1) == ghost_hidden_cell);
    const Field& q = bent.fields().require("pressure");
    CHECK(q.array.get(0) == 10);
    CHECK(q.array.get(5) == 60);
    CHECK(bent.stats(q).nan == 3);  // of the four without a value one is hidden

    const auto* axes = all[2].second->as<RectilinearGrid>();
    REQUIRE(axes);
    CHECK(axes->y.get(2) == 5);
    CHECK(all[2].second->fields().require("velocity").array.get(1, 2) == -2);

    const auto* even = all[3].second->as<UniformGrid>();
    REQUIRE(even);
    CHECK(even->dims == std::array<size_t, 3>{2, 2, 1});
    CHECK(even->extent_start[0] == 2);
    CHECK(even->spacing == Vec3{0.5, 0.25, 2});
    const Field& t = all[3].second->fields().require("stress");
    CHECK(t.components() == 6);
    CHECK(t.array.get(0, 3) == 3);  // xy
    CHECK(t.array.get(0, 4) == 5);  // yz is EnSight's sixth
    CHECK(t.array.get(0, 5) == 4);
    CHECK(all[3].second->fields().require("strain").array.get(3, 8) == 8);
  }
}

TEST_CASE("ensight: only the fields that are asked for are read, and a quick look reads no values") {
  CaseFiles files = model(Writing::c_little);
  files["m.vel"] = "damaged";
  const std::string path = write_case("ens_some", files) + "m.case";
  ReadOptions o;
  o.fields = {"pressure"};
  const Data data = read_any(path, o);
  CHECK(leaf(data, 0)->fields().size() == 1);
  CHECK(leaf(data, 3)->fields().empty());
  CHECK(contains(error_of([&] { read_any(path); }), "m.vel"));

  ReadOptions look;
  look.header_only = true;
  const Data quick = read_any(write_case("ens_look", model(Writing::c_big)) + "m.case", look);
  const Field& t = leaf(quick, 3)->fields().require("strain");
  CHECK(t.components() == 9);
  CHECK(t.array.count() == 4);
  CHECK(t.array.stride_bytes() == 0);
}

TEST_CASE("ensight: time sets choose files by pattern, and steps in a file by their marks") {
  const std::string times =
      "TIME\ntime set: 1\nnumber of steps: 3\nfilename start number: 4\nfilename increment: 2\ntime values: 0.5\n 1.5 2.5\n"
      "time set: 2 slow\nnumber of steps: 2\ntime values: 0.5 2.0\nFILE\nfile set: 7\nnumber of steps: 2\n";
  for (const Writing form : all_forms) {
    CaseFiles files = model(form);
    std::string single;
    {
      Emit head{form};
      head.head();
      single = head.out;
    }
    for (const float shift : {0.0f, 100.0f}) {
      Emit mark{form};
      mark.line("BEGIN TIME STEP");
      single += mark.out + geometry(form, shift, false);
      Emit end{form};
      end.line("END TIME STEP");
      single += end.out;
    }
    files["moving.geo"] = single;
    for (const int k : {4, 6, 8}) {
      Emit e{form};
      e.line("a step"), e.line("part"), e.ints({4}), e.line("block"), e.reals(std::vector<float>(4, float(k)));
      files[fmt::format("v.{:04}", k)] = e.out;
    }
    files["t.case"] =
        "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: 2 7 moving.geo\nVARIABLE\nscalar per node: 1 v v.****\n"
        "constant per case: 1 c 10 20 30\n" +
        times;
    const std::string path = write_case("ens_time" + std::to_string(int(form)), files) + "t.case";
    Context context;
    CHECK(file_times(path, {}, context) == std::vector<double>{0.5, 1.5, 2.0, 2.5});
    auto at = [&](double t) {
      ReadOptions o;
      o.time = t;
      return leaf(read_any(path, o), 3)->fields().require("v").array.get(0);
    };
    CHECK(at(0.5) == 4);
    CHECK(at(1.6) == 6);
    CHECK(at(2.0) == 6);  // the set of v has no step at 2.0: the last one before it
    CHECK(at(9) == 8);
    ReadOptions o;
    o.step = 3;
    const Data last = read_any(path, o);
    CHECK(leaf(last, 0)->bounds().lo.x == 100);
    CHECK(leaf(last, 0)->fields().require("c").array.get(0) == 30);
    CHECK(leaf(last, 0)->time() == 2.5);
    CHECK(leaf(read_any(path), 0)->bounds().lo.x == 0);
    o.step = 4;
    CHECK(contains(error_of([&] { read_any(path, o); }), "no time step 4"));
  }
}

TEST_CASE("ensight: measured particles are a part of points with their own values") {
  for (const Writing form : {Writing::ascii, Writing::c_big}) {
    CaseFiles files = model(form);
    Emit e{form};
    e.head();
    e.line("droplets"), e.line("particle coordinates"), e.ints({2});
    if (form == Writing::ascii) e.out += "       7 1.00000e+00 2.00000e+00 3.00000e+00\n       8 4.00000e+00 5.00000e+00 6.00000e+00\n";
    else e.ints({7, 8}), e.reals({1, 2, 3, 4, 5, 6});
    files["m.mea"] = e.out;
    Emit v{form};
    v.line("speed"), v.reals({10, 11, 12, 20, 21, 22});
    files["m.msp"] = v.out;
    files["m.case"] =
        "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: m.geo\nmeasured: m.mea\nVARIABLE\nvector per measured node: speed m.msp\n";
    const Data data = read_any(write_case("ens_measured" + std::to_string(int(form)), files) + "m.case");
    const auto all = leaves(data);
    REQUIRE(all.size() == 5);
    CHECK(all[4].first == "measured particles");
    const auto* cloud = all[4].second->as<PointCloud>();
    REQUIRE(cloud);
    CHECK(cloud->points.at(1) == Vec3{4, 5, 6});
    CHECK(all[4].second->fields().require("speed").array.get(1, 2) == 22);
  }
}

TEST_CASE("ensight: columns of text that touch are told apart") {
  CaseFiles files = model(Writing::ascii);
  Emit e{Writing::ascii};
  e.line("touching"), e.line("part"), e.ints({4}), e.line("block");
  e.out += "-1.00000e+00-2.50000e+00\n 3.300003+000\n 4.00000e+01\n";
  files["m.scl"] = e.out;
  const Data data = read_any(write_case("ens_touch", files) + "m.case");
  const Array& a = leaf(data, 3)->fields().require("pressure").array;
  CHECK(a.get(0) == -1);
  CHECK(a.get(1) == -2.5);
  CHECK(a.get(2) == double(3.300003f));
  CHECK(a.get(3) == 40);

  CaseFiles ids = model(Writing::ascii);
  std::string& g = ids["m.geo"];
  const std::string wide = fmt::format("{:10}{:10}{:10}", 1, 2, 9);
  const size_t at = g.find(wide);
  REQUIRE(at != std::string::npos);
  g.replace(at, wide.size(), "000000000100000000020000000009");
  CHECK(leaf(read_any(write_case("ens_wide", ids) + "m.case"), 0)->cell_count() == 6);
}

TEST_CASE("ensight: errors say what is wrong and where") {
  auto refused = [](const std::string& which, const std::string& from, const std::string& to) {
    CaseFiles files = model(Writing::ascii);
    std::string& s = files[which];
    const size_t at = s.find(from);
    REQUIRE(at != std::string::npos);
    s.replace(at, from.size(), to);
    return error_of([&] { read_any(write_case("ens_bad", files) + "m.case"); });
  };
  CHECK(contains(refused("m.case", "ensight gold", "ensight 5"), "type 'ensight 5' is not supported"));
  CHECK(contains(refused("m.case", "model: m.geo", ""), "not name a geometry"));
  CHECK(contains(refused("m.case", "pressure m.scl", "pressure"), "line 8"));
  CHECK(contains(refused("m.case", "pressure m.scl", "pressure none.scl"), "none.scl"));
  CHECK(contains(refused("m.case", "pressure m.scl", "3 pressure m.scl"), "time set 3"));
  CHECK(contains(refused("m.case", "pressure m.scl", "pressure m.**"), "no time set"));
  CHECK(contains(refused("m.case", "gamma 1.4", "gamma x"), "'x' is not a number"));
  CHECK(contains(refused("m.geo", "node id given", "node id maybe"), "use off, given, assign or ignore"));
  CHECK(contains(refused("m.geo", "coordinates\n        10", "coordinates\n2147483647"), "do not fit"));
  CHECK(contains(refused("m.geo", "coordinates\n        10", "coordinates\n        -1"), "do not fit"));
  CHECK(contains(refused("m.geo", fmt::format("{:10}{:10}{:10}", 1, 2, 9), fmt::format("{:10}{:10}{:10}", 1, 2, 11)),
                 "node 11, but nodes are 1 to 10"));
  CHECK(contains(refused("m.geo", "block rectilinear\n         2", "block rectilinear\n         0"), "a block of 0 x 3 x 2"));
  CHECK(contains(refused("m.geo", "         9\n         3         4", "         9\n         3        44"), "a range from 3 to 44"));
  CHECK(contains(refused("m.scl", "part\n         2", "part\n         7"), "part 7 is not in the geometry"));
  CHECK(contains(refused("m.scl", "coordinates", "cordinates"), "where 'coordinates' was expected"));
  CHECK(contains(refused("m.scl", "         6\n", "         9\n"), "position 9 of 6"));
  CHECK(contains(refused("m.vel", "hexa8", "nsided"), "no (further) elements 'nsided'"));
  const std::string message = refused("m.vel", "7.00000e+00", "seven");
  CHECK(contains(message, "'seven' is not a number"));
  CHECK(contains(message, "m.vel"));
}

TEST_CASE("ensight: damaged files give an error or a valid model") {
  for (const Writing form : {Writing::ascii, Writing::c_big, Writing::fortran_little}) {
    const CaseFiles files = model(form);
    const std::string name = "ens_damage" + std::to_string(int(form));
    CHECK(cut_and_damage_case(name, files, "m.geo", "m.case") > 40);
    CHECK(cut_and_damage_case(name, files, "m.scl", "m.case") > 25);
    CHECK(cut_and_damage_case(name, files, "m.vel", "m.case") > 25);
  }
  cut_and_damage_case("ens_damage_case", model(Writing::c_little), "m.case", "m.case");
}
