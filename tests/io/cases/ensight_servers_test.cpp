// SPDX-License-Identifier: Apache-2.0
// EnSight's server of servers: portions of one model in several cases.
#include <fmt/core.h>

#include "io/cases/case_files.h"

using namespace sg;
using namespace test;

namespace {

// A triangle at `x` in part 1 ("wing"), and a part 2 that only some have points in.
std::string portion_geometry(int x, bool second) {
  const auto numbers = [](std::initializer_list<int> v) {
    std::string s;
    for (const int k : v) s += fmt::format("{:12.5e}\n", double(k));
    return s;
  };
  const auto triangle = "tria3\n         1\n         1         2         3\n";
  std::string s = "portion\nof a model\nnode id off\nelement id off\npart\n         1\nwing\ncoordinates\n         3\n" +
                  numbers({x, x + 1, x, 0, 0, 1, 0, 0, 0}) + triangle + "part\n         2\ntail\ncoordinates\n";
  if (!second) return s + "         0\n";
  return s + "         3\n" + numbers({x, x + 1, x, 5, 5, 6, 0, 0, 0}) + triangle;
}

std::string portion_values(int first) {
  return fmt::format("p\npart\n         1\ncoordinates\n{:12.5e}\n{:12.5e}\n{:12.5e}\n", double(first), double(first + 1),
                     double(first + 2));
}

std::string portion_case(const std::string& name) {
  return "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: " + name + ".geo\nVARIABLE\nscalar per node: 1 p " + name +
         ".p*\nTIME\ntime set: 1\nnumber of steps: 2\nfilename start number: 0\nfilename increment: 1\ntime values: 0 2.5\n";
}

std::string sos(const std::string& servers, int count = 2) {
  return "# a model\nFORMAT\ntype: master_server gold\n\nSERVERS\nnumber of servers: " + std::to_string(count) + "\n" + servers;
}

const std::string two =
    "#Server 1\nmachine id: a\nexecutable: ensight8.server\ndata_path: left\ncasefile: a.case\n"
    "machine id: b\nexecutable: ensight8.server\ncasefile: right/b.case\n";

CaseFiles two_portions(const std::string& text) {
  return {{"m.sos", text},
          {"left/a.case", portion_case("a")},
          {"left/a.geo", portion_geometry(0, false)},
          {"left/a.p0", portion_values(1)},
          {"left/a.p1", portion_values(11)},
          {"right/b.case", portion_case("b")},
          {"right/b.geo", portion_geometry(1, true)},
          {"right/b.p0", portion_values(4)},
          {"right/b.p1", portion_values(14)}};
}

}  // namespace

TEST_CASE("ensight servers: parts of all cases are joined, those that are empty at a server left out") {
  const std::string path = write_case("sos", two_portions(sos(two))) + "m.sos";
  const Data data = read_any(path);
  const auto all = leaves(data);
  REQUIRE(all.size() == 3);
  CHECK(all[0].first == "wing/server 1");
  CHECK(all[1].first == "wing/server 2");
  CHECK(all[2].first == "tail");
  CHECK(all[1].second->bounds().hi.x == 2);
  CHECK(all[1].second->fields().require("p").array.get(0) == 4);
  CHECK(all[2].second->bounds().lo.y == 5);
  Context context;
  CHECK(file_times(path, {}, context) == std::vector<double>{0, 2.5});
  ReadOptions late;
  late.step = 1;
  const Data then = read_any(path, late);
  CHECK(leaf(then, 0)->time() == 2.5);
  CHECK(leaf(then, 1)->fields().require("p").array.get(2) == 16);
  check_names_alone(path);
}

TEST_CASE("ensight servers: processes share the cases") {
  const std::string path = write_case("sos", two_portions(sos(two))) + "m.sos";
  ReadOptions second;
  second.piece = 1, second.pieces = 2;
  const auto mine = leaves(read_any(path, second));
  REQUIRE(mine.size() == 2);
  CHECK(mine[0].first == "wing");
  CHECK(mine[0].second->bounds().lo.x == 1);
}

TEST_CASE("ensight servers: other ways to write the file, and case files that were copied beside it") {
  const auto parts = [](const std::string& text) { return leaves(read_any(write_case("sos", two_portions(text)) + "m.sos")).size(); };
  // A colon behind the section, paths behind the case files, no machines.
  CHECK(parts("FORMAT:\ntype: master_server gold\nSERVERS\nnumber of servers: 2\ncasefile: a.case\ndata_path: left\ncasefile: b.case\n"
              "data_path: right\n") == 3);
  // One case that all servers read.
  CHECK(parts(sos("machine id: a\ncasefile: left/a.case\nmachine id: b\ncasefile: left/a.case\n")) == 2);
  CHECK(parts("FORMAT\ntype: master_server gold\nSERVERS\nnumber of servers: 4 repeat\nmachine id: a\ncasefile: \"left/a.case\"\n") == 2);
  CHECK(parts(sos("casefile: left/a.case\ncasefile: ./left/a.case\ncasefile: right/../left/a.case\n", 3)) ==
        parts(sos("casefile: left/a.case\n", 1)));
  // More cases than servers.
  const std::string several =
      "FORMAT\ntype: master_server gold\nSERVERS\nnumber of servers: 1\nmachine id: a\nMULTIPLE_CASEFILES\n"
      "total number of cfiles: 2\n";
  CHECK(parts(several + "cfiles: left/a.case\nright/b.case\n") == 3);
  CaseFiles numbered = two_portions(several +
                                    "cfiles global path: ./left\ncfiles pattern: c**.case\ncfiles start number: 8\n"
                                    "cfiles increment: 2\n");
  numbered["left/c08.case"] = numbered["left/a.case"];
  numbered["left/c10.case"] = numbered["left/a.case"];
  CHECK(leaves(read_any(write_case("sos", numbered) + "m.sos")).size() == 3);
  // The path of another machine.
  CHECK(parts(sos("machine id: a\ndata_path: /scratch/run\ncasefile: left/a.case\nmachine id: b\ncasefile: /far/away/left/b.case\n", 1)) ==
        2);
}

TEST_CASE("ensight servers: a case file that is missing is told, and the rest is read") {
  CaseFiles files = two_portions(sos(two));
  files.erase("right/b.case");
  const std::string root = write_case("sos_missing", files);
  Context context;
  std::string told;
  context.on_log = [&](LogLevel, std::string_view text) { told += text; };
  CHECK(leaves(read_data(root + "m.sos", {}, context)).size() == 2);
  CHECK(contains(told, "right/b.case"));
  std::remove((root + "left/a.case").c_str());
  CHECK(contains(error_of([&] { read_any(root + "m.sos"); }), "no such file"));
}

TEST_CASE("ensight servers: errors say what is wrong and where") {
  const auto refused = [](const std::string& text) { return error_of([&] { read_any(write_case("sos", two_portions(text)) + "m.sos"); }); };
  CHECK(contains(refused(sos(two, 3)), "announces 3 case files but names 2"));
  CHECK(contains(refused(sos(two, 2'000'000)), "line 6: '2000000'"));
  CHECK(contains(refused("FORMAT\ntype: master_server plot3d\nSERVERS\nnumber of servers: 1\ncasefile: x\n"), "line 2: type"));
  CHECK(contains(refused("FORMAT\ntype: master_server gold\n"), "how many servers"));
  CHECK(contains(refused(sos("casefile: ../../a.case\n", 1)), "neither below its own folder"));
  CHECK(contains(refused(sos("data_path: /nowhere\ncasefile: a.case\n", 1)), "absolute path"));
  CHECK(contains(refused("FORMAT\ntype: master_server gold\nMULTIPLE_CASEFILES\ncfiles file: list.txt\n"), "'cfiles file'"));
  CHECK(contains(refused("FORMAT\ntype: master_server gold\nMULTIPLE_CASEFILES\ntotal number of cfiles: 100000\ncfiles pattern: a*" +
                         std::string(2000, 'x') + "\n"),
                 "names 100000 case files of 2002 characters"));
  cut_and_damage_case("sos_damage", two_portions(sos(two)), "m.sos", "m.sos");
}
