// SPDX-License-Identifier: Apache-2.0
// EnSight 6: one model in all forms, and bad input.
#include <fmt/core.h>

#include "base/bytes.h"
#include "case_files.h"

using namespace sg;
using namespace sg::test;

namespace ensight6 {
namespace {

enum class Writing { ascii, little, big };

struct Emit {
  Writing form;
  std::string out{};

  void line(const std::string& text) { out += form == Writing::ascii ? text + "\n" : text + std::string(80 - text.size(), ' '); }
  void ints(const std::vector<int>& v) {
    for (const int x : v)
      if (form == Writing::ascii) out += fmt::format("{:8}", x);
      else put_bytes(out, int32_t(x), form == Writing::big);
    if (form == Writing::ascii) out += "\n";
  }
  // Six numbers a line, which may touch.
  void reals(const std::vector<float>& v) {
    for (size_t i = 0; i < v.size(); ++i)
      if (form == Writing::ascii) out += fmt::format("{:12.5e}", v[i]) + ((i + 1) % 6 == 0 || i + 1 == v.size() ? "\n" : "");
      else put_bytes(out, v[i], form == Writing::big);
  }
};

// Nodes 100 to 104: a tetrahedron on nodes 1, 2, 3 and 5 of the list, a square on 1 to 4; and a block of four nodes.
const std::vector<float> places{0, 0, 0, -1, 0, 0, -1, -2, 0, 0, -2, 0, 0, 0, -3};

std::string geometry(Writing form) {
  Emit e{form};
  if (form != Writing::ascii) e.line("C Binary");
  e.line("a model"), e.line("of three parts"), e.line("node id given"), e.line("element id given");
  e.line("coordinates"), e.ints({5});
  if (form == Writing::ascii) {
    for (int i = 0; i < 5; ++i)
      e.out += fmt::format("{:8}{:12.5e}{:12.5e}{:12.5e}\n", 100 + i, places[size_t(3 * i)], places[size_t(3 * i + 1)],
                           places[size_t(3 * i + 2)]);
  } else {
    e.ints({100, 101, 102, 103, 104}), e.reals(places);
  }
  const auto element = [&](const std::string& type, int id, std::vector<int> nodes) {
    e.line(type), e.ints({1});
    if (form == Writing::ascii) nodes.insert(nodes.begin(), id);
    else e.ints({id});
    e.ints(nodes);
  };
  e.line("part 1"), e.line("solid"), element("tetra4", 7, {100, 101, 102, 104});
  e.line("part 2"), e.line("sheet"), element("quad4", 8, {100, 101, 102, 103});
  e.line("part 5"), e.line("grid"), e.line("block"), e.ints({2, 2, 1});
  e.reals({0, 1, 0, 1}), e.reals({0, 0, 1, 1}), e.reals({5, 5, 5, 5});
  return e.out;
}

CaseFiles model(Writing form) {
  CaseFiles files;
  files["m.case"] =
      "FORMAT\ntype: ensight\nGEOMETRY\nmodel: m.geo\nVARIABLE\nscalar per node: p m.scl\nvector per node: v m.vec\n"
      "tensor symm per element: s m.ten\n";
  files["m.geo"] = geometry(form);
  Emit p{form}, v{form}, s{form};
  p.line("pressure"), p.reals({10, 11, 12, 13, 14}), p.line("part 5"), p.line("block"), p.reals({1, 2, 3, 4});
  v.line("velocity");
  std::vector<float> all;
  for (int i = 0; i < 15; ++i) all.push_back(float(-i));
  v.reals(all), v.line("part 5"), v.line("block"), v.reals({1, 2, 3, 4}), v.reals({5, 6, 7, 8}), v.reals({9, 10, 11, 12});
  s.line("stress"), s.line("part 1"), s.line("tetra4"), s.reals({1, 2, 3, 4, 5, 6});
  files["m.scl"] = p.out, files["m.vec"] = v.out, files["m.ten"] = s.out;
  return files;
}

}  // namespace
}  // namespace ensight6

TEST_CASE("ensight 6: one model has the same parts and values in text and binary") {
  for (const ensight6::Writing form : {ensight6::Writing::ascii, ensight6::Writing::little, ensight6::Writing::big}) {
    CAPTURE(int(form));
    const auto all = leaves(read_any(write_case("ens6_" + std::to_string(int(form)), ensight6::model(form)) + "m.case"));
    REQUIRE(all.size() == 3);
    CHECK(all[0].first == "solid");
    const Dataset &solid = *all[0].second, &sheet = *all[1].second, &grid = *all[2].second;
    CHECK(solid.as<UnstructuredMesh>()->type(0) == CellType::tetra);
    CHECK(solid.point_count() == 4);
    CHECK(solid.bounds().lo == Vec3{-1, -2, -3});
    const Field& p = solid.fields().require("p", Association::point);
    for (size_t i = 0; i < 4; ++i) CHECK(p.array.get(i) == (i < 3 ? 10 + double(i) : 14));
    const Field& v = sheet.fields().require("v", Association::point);
    CHECK(v.role == Role::vectors);
    for (size_t i = 0; i < 4; ++i)
      for (int c = 0; c < 3; ++c) CHECK(v.array.get(i, c) == -double(3 * i + size_t(c)));
    const Field& s = solid.fields().require("s", Association::cell);
    const double xx_to_xz[] = {1, 2, 3, 4, 6, 5};
    for (int c = 0; c < 6; ++c) CHECK(s.array.get(0, c) == xx_to_xz[c]);
    REQUIRE(grid.as<CurvilinearGrid>());
    CHECK(grid.bounds().hi == Vec3{1, 1, 5});
    CHECK(grid.fields().require("p").array.get(3) == 4);
    CHECK(grid.fields().require("v").array.get(1, 2) == 10);
    CHECK(!grid.fields().find("s"));
  }
}

TEST_CASE("ensight 6: a quick look reads no values, and mistakes are told") {
  ReadOptions look;
  look.header_only = true;
  const Data quick = read_any(write_case("ens6_look", ensight6::model(ensight6::Writing::big)) + "m.case", look);
  CHECK(leaf(quick, 0)->fields().require("v").components() == 3);
  CHECK(leaf(quick, 0)->fields().require("v").array.count() == 4);
  const auto refused = [](const std::string& which, const std::string& from, const std::string& to) {
    CaseFiles files = ensight6::model(ensight6::Writing::ascii);
    std::string& s = files[which];
    const size_t at = s.find(from);
    REQUIRE(at != std::string::npos);
    s.replace(at, from.size(), to);
    return error_of([&] { read_any(write_case("ens6_bad", files) + "m.case"); });
  };
  CHECK(contains(refused("m.geo", "     101     102     104", "     101     102     109"), "node 109, which is not listed"));
  CHECK(contains(refused("m.geo", "part 2", "part x"), "does not number a part"));
  CHECK(contains(refused("m.geo", "quad4", "nsided"), "belong to EnSight Gold"));
  CHECK(contains(refused("m.scl", "part 5", "part 6"), "'part 6' is not in the geometry"));
  CHECK(contains(refused("m.ten", "tetra4", "hexa8"), "has no (further) elements 'hexa8'"));
}

TEST_CASE("ensight 6: files cut or changed anywhere read or give an Error") {
  for (const ensight6::Writing form : {ensight6::Writing::ascii, ensight6::Writing::little})
    for (const char* which : {"m.geo", "m.scl", "m.ten"}) {
      const CaseFiles good = ensight6::model(form);
      const std::string& text = good.at(which);
      for (size_t i = 0; i < text.size(); i += 1 + text.size() / 60) {
        for (const bool cut : {true, false}) {
          CaseFiles files = good;
          if (cut) files[which] = text.substr(0, i);
          else files[which][i] = char(text[i] ^ 0x55);
          try {
            read_any(write_case("ens6_cut", files) + "m.case");
          } catch (const Error& e) {
            CHECK(e.kind() == ErrorKind::data);
          }
        }
      }
    }
}
