// SPDX-License-Identifier: Apache-2.0
// AMReX plotfiles: two levels in 2D and 3D, FABs with a border, both widths and orders, and bad input.
#include <fmt/core.h>

#include "case_files.h"

using namespace sg;
using namespace sg::test;

namespace {

std::string tuple(const std::vector<int>& v) {
  std::string s = "(";
  for (size_t i = 0; i < v.size(); ++i) s += fmt::format("{}{}", i ? "," : "", v[i]);
  return s + ")";
}

struct TestBox {
  std::vector<int> lo, hi;
  std::string text() const { return "(" + tuple(lo) + " " + tuple(hi) + " " + tuple(std::vector<int>(lo.size(), 0)) + ")"; }
};

double value(int component, const std::vector<int>& at) {
  double v = component * 10000;
  for (size_t a = 0; a < at.size(); ++a) v += at[a] * (a == 0 ? 1 : a == 1 ? 20 : 400);
  return v;
}

std::string fab(const TestBox& inner, int border, bool single, bool big) {
  TestBox b = inner;
  for (size_t a = 0; a < b.lo.size(); ++a) b.lo[a] -= border, b.hi[a] += border;
  const std::string order =
      single ? (big ? "(4, (1 2 3 4))" : "(4, (4 3 2 1))") : (big ? "(8, (1 2 3 4 5 6 7 8))" : "(8, (8 7 6 5 4 3 2 1))");
  std::string s =
      std::string("FAB ((8, ") + (single ? "(32 8 23 0 1 9 0 127)" : "(64 11 52 0 1 12 0 1023)") + ")," + order + ")" + b.text() + " 2\n";
  const bool solid = b.lo.size() == 3;
  for (int c = 0; c < 2; ++c)
    for (int k = solid ? b.lo[2] : 0; k <= (solid ? b.hi[2] : 0); ++k)
      for (int j = b.lo[1]; j <= b.hi[1]; ++j)
        for (int i = b.lo[0]; i <= b.hi[0]; ++i) {
          const double v = value(c, solid ? std::vector<int>{i, j, k} : std::vector<int>{i, j});
          if (single) put_bytes(s, float(v), big);
          else put_bytes(s, v, big);
        }
  return s;
}

// Level 0: one box from (2,2,2) on; level 1, twice as fine, covers the middle with two boxes.
CaseFiles plotfile(int dimension, int border = 0, bool single = false, bool big = false, const std::string& ratio = "2") {
  const auto n = size_t(dimension);
  auto all = [&](int v) { return std::vector<int>(n, v); };
  const TestBox coarse{all(2), all(5)};
  TestBox left{all(6), all(9)}, right = left;
  left.hi[0] = 7, right.lo[0] = 8;
  CaseFiles f;
  std::string h = "HyperCLaw-V1.1\n2\nrho\nY(O 2)\n" + fmt::format("{}\n0.25\n1\n", dimension);
  for (size_t a = 0; a < n; ++a) h += "1 ";
  h += "\n";
  for (size_t a = 0; a < n; ++a) h += "3 ";
  h += "\n" + ratio + "\n" + coarse.text() + " " + TestBox{all(4), all(11)}.text() + "\n7 7\n";
  for (const char* d : {"0.5 ", "0.25 "}) {
    for (size_t a = 0; a < n; ++a) h += d;
    h += "\n";
  }
  h += "0\n0\n0 1 0.25\n7\n";
  for (size_t a = 0; a < n; ++a) h += "1 3\n";
  h += "Level_0/Cell\n1 2 0.25\n7\n";
  for (size_t a = 0; a < 2 * n; ++a) h += "1 2\n";
  h += "Level_1/Cell\n";
  f["Header"] = h;
  const std::string a = fab(coarse, border, single, big), b = fab(left, border, single, big), c = fab(right, border, single, big);
  f["Level_0/Cell_H"] = "1\n1\n2\n0\n(1 0\n" + coarse.text() + "\n)\n1\nFabOnDisk: Cell_D_00000 0\n\n";
  f["Level_0/Cell_D_00000"] = a;
  f["Level_1/Cell_H"] = "1\n1\n2\n0\n(2 0\n" + left.text() + "\n" + right.text() +
                        "\n)\n2\nFabOnDisk: Cell_D_00000 3\nFabOnDisk: Cell_D_00000 " + fmt::format("{}\n\n", 3 + b.size());
  f["Level_1/Cell_D_00000"] = "pad" + b + c;
  return f;
}

DatasetPtr read_plot(const std::string& name, const CaseFiles& files, const ReadOptions& o = {}) {
  return std::get<DatasetPtr>(read_any(write_case(name, files), o));
}

}  // namespace

TEST_CASE("amrex: levels, boxes and values, with borders, in both widths and orders") {
  for (const int dimension : {2, 3})
    for (const int border : {0, 1})
      for (const bool single : {false, true})
        for (const bool big : {false, true}) {
          const std::string ratio = border == 0 ? "2" : dimension == 2 ? "(2,2)" : "(2,2,2)";
          const auto d =
              read_plot(fmt::format("plt{}{}{}{}", dimension, border, single, big), plotfile(dimension, border, single, big, ratio));
          const auto* g = d->as<AmrGrid>();
          REQUIRE(g);
          CHECK(g->dimension == dimension);
          REQUIRE(g->levels.size() == 2);
          CHECK(g->levels[1].patches.size() == 2);
          CHECK(g->levels[1].ratio[1] == 2);
          CHECK(d->time() == 0.25);
          CHECK(d->bounds().lo.x == 1);  // box (2,..) begins at the domain's corner
          CHECK(d->bounds().hi.y == 3);
          const size_t coarse = dimension == 3 ? 64 : 16, fine = dimension == 3 ? 64 : 16;
          CHECK(d->cell_count() == coarse + fine);
          const Field& f = d->fields().require("Y(O 2)", Association::cell);
          CHECK(f.array.type() == (single ? ElementType::f32 : ElementType::f64));
          // Cell (3, 4, [2]) of level 0 and (8, 9, [6]) of the second patch of level 1.
          CHECK(f.array.get(1 + 4 * 2) == value(1, dimension == 3 ? std::vector<int>{3, 4, 2} : std::vector<int>{3, 4}));
          CHECK(f.array.get(g->levels[1].patches[1].cell_offset + 2 * 3) ==
                value(1, dimension == 3 ? std::vector<int>{8, 9, 6} : std::vector<int>{8, 9}));
          // The middle (3..4 along each axis) of level 0 is covered.
          size_t covered = 0;
          for (size_t c = 0; c < d->cell_count(); ++c) covered += d->cell_ghost().get(c) == double(ghost_refined_cell);
          CHECK(covered == (dimension == 3 ? 8u : 4u));
          CHECK(d->cell_ghost().get(dimension == 3 ? 1 + 4 + 16 : 1 + 4) == ghost_refined_cell);
          CHECK(d->cell_ghost().get(0) == 0);
        }
}

TEST_CASE("amrex: the volumes of the cells that are seen sum to the domain") {
  for (const int dimension : {2, 3}) {
    const auto d = read_plot("plt_volume", plotfile(dimension));
    const auto* g = d->as<AmrGrid>();
    double sum = 0;
    for (const auto& level : g->levels)
      for (const auto& p : level.patches) {
        const auto n = p.cells();
        for (size_t c = 0; c < n[0] * n[1] * n[2]; ++c)
          if (d->cell_ghost().get(p.cell_offset + c) == 0) sum += std::pow(level.spacing.x, dimension);
      }
    CHECK(sum == doctest::Approx(std::pow(2.0, dimension)));
  }
}

TEST_CASE("amrex: one field, no values, and the same on one thread and on eight") {
  const CaseFiles files = plotfile(3, 1);
  ReadOptions o;
  o.fields = {"rho"};
  const auto one = read_plot("plt_one", files, o);
  CHECK(one->fields().size() == 1);
  CHECK(one->fields()[0].array.get(0) == value(0, {2, 2, 2}));
  o.fields.clear(), o.header_only = true;
  CHECK(read_plot("plt_look", files, o)->fields()[1].array.stride_bytes() == 0);
  auto read = [&] { return read_plot("plt_threads", files); };
  const auto a = with_threads(1, read), b = with_threads(8, read);
  CHECK(same_array(a->fields()[1].array, b->fields()[1].array));
  CHECK(same_array(a->cell_ghost(), b->cell_ghost()));
}

TEST_CASE("amrex: errors say what is wrong and where") {
  auto refused = [](const std::string& which, const std::string& from, const std::string& to) {
    CaseFiles files = plotfile(3);
    std::string& s = files[which];
    const size_t at = s.find(from);
    REQUIRE(at != std::string::npos);
    s.replace(at, from.size(), to);
    return error_of([&] { read_plot("plt_bad", files); });
  };
  CHECK(contains(refused("Header", "\n2\nrho", "\n3\nrho"), "Header"));
  CHECK(contains(refused("Header", "0.5 0.5", "-0.5 0.5"), "a spacing is -0.5"));
  CHECK(contains(refused("Header", "\n2\n((", "\n0\n(("), "ratio is 0"));
  CHECK(contains(refused("Header", "((2,2,2) (5", "((2,2,2) (1"), "the domain of level 0"));
  CHECK(contains(refused("Level_0/Cell_H", "(1 0", "(2 0"), "'(1 0' was expected"));
  CHECK(contains(refused("Level_0/Cell_H", "((2,2,2) (5,5,5)", "((2,2,2) (50,5,5)"), "does not cover its box"));
  CHECK(contains(refused("Level_0/Cell_H", "00000 0", "00000 9999999"), "the file has"));
  CHECK(contains(refused("Level_0/Cell_H", "Cell_D_00000", "Cell_D_00001"), "Cell_D_00001"));
  CHECK(contains(refused("Level_0/Cell_D_00000", "(8 7 6 5 4 3 2 1)", "(2 1 4 3 6 5 8 7)"), "mixed byte order"));
  CHECK(contains(refused("Level_0/Cell_D_00000", "(64 11", "(16 11"), "numbers of 16 bits"));
  CHECK(contains(refused("Level_0/Cell_D_00000", "0)) 2\n", "0)) 1\n"), "components, expected 2"));
  CHECK(contains(refused("Level_0/Cell_D_00000", "(5,5,5)", "(9000000,9000000,9000000)"), "too large"));
  CHECK(contains(refused("Level_0/Cell_D_00000", "(5,5,5)", "(5,5,9)"), "bytes, "));
  // Many boxes that share the bytes of one.
  CaseFiles files = plotfile(3);
  const int n = 2000;
  std::string boxes, fabs;
  for (int i = 0; i < n; ++i) boxes += "((2,2,2) (5,5,5) (0,0,0))\n", fabs += "FabOnDisk: Cell_D_00000 0\n";
  files["Level_0/Cell_H"] = fmt::format("1\n1\n2\n0\n({} 0\n{})\n{}\n{}", n, boxes, n, fabs);
  std::string& h = files["Header"];
  std::string space;
  for (int i = 0; i < n; ++i) space += "1 3\n1 3\n1 3\n";
  const size_t at = h.find("0 1 0.25\n7\n1 3\n1 3\n1 3\n");
  REQUIRE(at != std::string::npos);
  h.replace(at, 23, fmt::format("0 {} 0.25\n7\n{}", n, space));
  CHECK(contains(error_of([&] { read_plot("plt_shared", files); }), "cells, but its files hold"));
}

TEST_CASE("amrex: damaged files give an error or a valid grid") {
  const CaseFiles files = plotfile(2);
  CHECK(cut_and_damage_case("plt_damage", files, "Header", "") > 60);
  CHECK(cut_and_damage_case("plt_damage", files, "Level_1/Cell_H", "") > 55);
  CHECK(cut_and_damage_case("plt_damage", files, "Level_1/Cell_D_00000", "") == 63);
}
