// SPDX-License-Identifier: Apache-2.0
// Quadratic cells that a legacy file calls by the linear cell of their shape.
#include <fmt/core.h>

#include "base/file/file.h"
#include "data/cells/cell_reader.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;

namespace {

DatasetPtr read(const std::string& cells, int points, std::vector<std::string>& said) {
  std::string text = fmt::format("# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} float\n", points);
  for (int i = 0; i < points; ++i) text += fmt::format("{} {} {}\n", i, i * i % 7, i * i * i % 5);
  const std::string path = test::fresh_folder("named_linear") + "a.vtk";
  write_file(path, text + cells);
  Context context;
  context.on_log = [&](LogLevel level, std::string_view line) {
    if (level == LogLevel::warning) said.emplace_back(line);
  };
  return single_dataset(read_data(path, {}, context), "test");
}

}  // namespace

TEST_CASE("vtk legacy: a hexahedron of 20 points is a quadratic one, with a warning") {
  std::string ids = "20";
  for (int i = 0; i < 20; ++i) ids += fmt::format(" {}", i);
  std::vector<std::string> said;
  const DatasetPtr d = read("CELLS 1 21\n" + ids + "\nCELL_TYPES 1\n12\n", 20, said);
  CHECK(d->as<UnstructuredMesh>()->type(0) == CellType::quadratic_hexahedron);
  REQUIRE(said.size() == 1);
  CHECK(test::contains(said[0], "1 cells have more points"));
}

TEST_CASE("vtk legacy: among other cells, those alone; numbers of points that fit no cell are refused") {
  std::vector<std::string> said;
  const DatasetPtr d = read("CELLS 2 12\n4 0 1 2 3\n6 0 1 2 4 5 6\nCELL_TYPES 2\n10\n5\n", 7, said);
  CHECK(d->as<UnstructuredMesh>()->type(0) == CellType::tetra);
  CHECK(d->as<UnstructuredMesh>()->type(1) == CellType::quadratic_triangle);
  CHECK(said.size() == 1);
  CHECK(test::contains(test::error_of([&] { read("CELLS 1 8\n7 0 1 2 3 4 5 6\nCELL_TYPES 1\n12\n", 7, said); }),
                       "is a Hexahedron of 7 points"));
}
