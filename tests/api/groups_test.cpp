// SPDX-License-Identifier: Apache-2.0
// The library for C++ programs: turned grids, patches, polyhedra, tables and collections from memory.
#include <cmath>
#include <numeric>

#include "api/api_errors.h"
#include "api/sightglass.h"
#include "support/test.h"

using namespace sightglass;
using sg::test::contains;
using sg::test::refused;

TEST_CASE("library: a grid lies along the axes that it was given") {
  const double c = std::cos(0.3), s = std::sin(0.3);
  const Placing placing{{1, 2, 4}, {10, 20, 30}, {Vec3{3 * c, 3 * s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}}};
  const Data grid = uniform_grid({2, 3, 4}, placing);
  const auto points = grid.points().numbers();
  const size_t point = 1 + 2 * (2 + 3 * 3);  // (1, 2, 3)
  CHECK(points[3 * point] == doctest::Approx(10 + 1 * c - 4 * s));
  const Placing there = grid.placing();
  for (size_t a = 0; a < 3; ++a) {
    CHECK(there.spacing[a] == placing.spacing[a]);
    CHECK(there.origin[a] == placing.origin[a]);
  }
  CHECK(there.axes[0][1] == doctest::Approx(s));  // of length 1
  CHECK(contains(refused([&] { uniform_grid({2, 2, 2}, {{1, 1, 1}, {}, {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 1, 0}}}); }), "in a plane"));
  CHECK(contains(refused([&] { uniform_grid({2, 2, 2}, {{1, 1, 1}, {}, {Vec3{0, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 1, 0}}}); }), "length 0"));
  CHECK(uniform_grid({3, 2, 2}, {0.5, 1, 1}, {1, 0, 0}).coordinates()[0].numbers() == std::vector<double>{1, 1.5, 2});
}

TEST_CASE("library: cells under finer patches of a grid do not count twice") {
  const Data grid = amr_grid({{{1, 1, 1}, {{{0, 0, 0}, {3, 3, 3}}}}, {{0.5, 0.5, 0.5}, {{{2, 2, 2}, {5, 5, 5}}}}});
  CHECK(grid.kind() == "amr");
  CHECK(grid.cell_count() == 64 + 64);
  const Data one = grid.with_cell_field("one", std::vector<float>(128, 1.0f));
  CHECK(one.run("integrate").field("integral").values.get(1) == doctest::Approx(64));  // of the field: the volume, 4^3
  const Data flat = amr_grid({{{1, 1, 0}, {{{0, 0, 0}, {3, 3, 0}}}}, {{0.25, 0.25, 0}, {{{0, 0, 0}, {7, 3, 0}}}}});
  CHECK(flat.cell_count() == 16 + 32);
  CHECK(contains(refused([] { amr_grid({{{1, 1, 1}, {}}, {{0.3, 0.5, 0.5}, {}}}); }), "whole share"));
  CHECK(contains(refused([] { amr_grid({}); }), "no levels"));
  CHECK(!refused([] { amr_grid({{{1, 1, 1}, {{{5, 0, 0}, {0, 3, 3}}}}}); }).empty());
}

TEST_CASE("library: polyhedra go in and come out with their faces") {
  // A cube of side 2 of six quadrilaterals.
  std::vector<double> xyz;
  for (int i = 0; i < 8; ++i) xyz.insert(xyz.end(), {double(i & 1) * 2, double(i >> 1 & 1) * 2, double(i >> 2) * 2});
  std::vector<int64_t> ids(8);
  std::iota(ids.begin(), ids.end(), 0);
  Cells cells{ids, std::vector<int64_t>{0, 8}, std::vector<uint8_t>{42}, {}, {}, {}};
  const std::vector<int64_t> faces{0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
  cells.face_ids = faces, cells.face_offsets = std::vector<int64_t>{0, 4, 8, 12, 16, 20, 24}, cells.cell_faces = std::vector<int64_t>{0, 6};
  const Data cube = unstructured_mesh(Array(xyz, 3), cells).with_cell_field("one", std::vector<float>{1});
  const Cells back = cube.cells();
  CHECK(back.face_ids.numbers() == std::vector<double>(faces.begin(), faces.end()));
  CHECK(back.cell_faces.numbers() == std::vector<double>{0, 6});
  CHECK(cube.run("integrate").field("integral").values.get(1) == doctest::Approx(8));
  cells.cell_faces = std::vector<int64_t>{0, 7};
  CHECK(!refused([&] { unstructured_mesh(Array(xyz, 3), cells); }).empty());
}

TEST_CASE("library: tables hold numbers and words, collections parts of any kind") {
  const Data t = table({{"t", std::vector<double>{0, 1, 2}, "s", {}}, {"site", std::vector<int32_t>{1, -1, 0}, "", {"north", "south"}}});
  CHECK(t.kind() == "table");
  CHECK(t.field("t").unit == "s");
  CHECK(t.words("site") == std::vector<std::string>{"north", "south"});
  CHECK(t.field("site").values.numbers() == std::vector<double>{1, -1, 0});
  const std::string path = sg::test::temp_folder() + "t.csv";
  t.write(path);
  CHECK(read(path).words("site").size() == 2);
  CHECK(contains(refused([] { table({{"a", std::vector<int>{1}, "", {}}, {"b", std::vector<int>{1, 2}, "", {}}}); }), "has 2 rows"));
  CHECK(contains(refused([] { table({{"a", std::vector<int>{1}, "", {"x"}}}); }), "row 0 is word 1"));
  CHECK(contains(refused([] { table({{"a", std::vector<int>{1}, "", {}}, {"a", std::vector<int>{1}, "", {}}}); }), "two columns"));

  const Data both = collection({{"ball", source("gyroid", {{"size", 8}})}, {"more", collection({{"table", t}})}});
  CHECK(both.kind() == "collection");
  const auto parts = both.parts();
  REQUIRE(parts.size() == 2);
  CHECK(parts[0].first == "ball");
  CHECK(parts[1].first == "more/table");
  CHECK(parts[1].second.kind() == "table");
  CHECK(both.point_count() == 512);
}
