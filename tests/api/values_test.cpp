// SPDX-License-Identifier: Apache-2.0
// The library for C++ programs: numbers in and out, meshes from memory, questions.
#include <cmath>
#include <numeric>

#include "api/api_errors.h"
#include "api/sightglass.h"
#include "support/test.h"

using namespace sightglass;
using sg::test::refused;

namespace {

std::vector<float> counted(size_t n) {
  std::vector<float> v(n);
  std::iota(v.begin(), v.end(), 0.0f);
  return v;
}

}  // namespace

TEST_CASE("library: arrays keep the caller's numbers where they lie, and their owner alive") {
  auto owner = std::make_shared<std::vector<double>>(std::vector<double>{1, 2, 3, 4, 5, 6});
  std::weak_ptr<std::vector<double>> alive = owner;
  const double* where = owner->data();
  {
    Array a = Array::wrap<double>(*owner, 3, owner);
    const Data cloud = point_cloud(a);
    owner.reset(), a = {};
    CHECK(!alive.expired());
    CHECK(cloud.points().as<double>().data() == where);
    CHECK(cloud.point_count() == 2);
  }
  CHECK(alive.expired());
}

TEST_CASE("library: a field of the caller's comes back at the same address") {
  const std::vector<float> mine = counted(27);
  const Data grid = uniform_grid({3, 3, 3}).with_point_field("f", Array::wrap<float>(mine), "K");
  const Field f = grid.field("f");
  CHECK(f.values.as<float>().data() == mine.data());
  CHECK(f.unit == "K");
  CHECK(f.on == On::points);
  CHECK(grid.range("f").lo == 0);
  CHECK(grid.range("f").hi == 26);
  // Through a file the numbers stay, in new memory.
  const std::string path = sg::test::temp_folder() + "grid.vti";
  grid.write(path);
  CHECK(read(path).field("f").values.numbers() == std::vector<double>(mine.begin(), mine.end()));
}

TEST_CASE("library: numbers inside of records are read at their stride") {
  struct Node {
    double x, y, z;
    float t;
  };
  const std::vector<Node> nodes{{0, 0, 0, 5}, {1, 0, 0, 6}, {0, 2, 0, 7}};
  const Array points = Array::wrap_strided(&nodes[0].x, 3, 3, sizeof(Node));
  const Data triangle =
      triangle_mesh(points, std::vector<int32_t>{0, 1, 2}).with_point_field("t", Array::wrap_strided(&nodes[0].t, 3, 1, sizeof(Node)));
  CHECK(triangle.bounds().hi == Vec3{1, 2, 0});
  CHECK(triangle.field("t").values.numbers() == std::vector<double>{5, 6, 7});
  CHECK(triangle.run("integrate").field("measure").values.get(0) == doctest::Approx(1));
  CHECK(refused([&] { triangle.field("t").values.as<float>(); }).find("lie apart") != std::string::npos);
  CHECK(refused([&] { Array::wrap_strided(&nodes[0].t, 3, 1, 7); }).find("multiple of 4") != std::string::npos);
}

TEST_CASE("library: meshes of every kind from memory have the sizes that follow from them") {
  const std::vector<double> xyz{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};  // the unit cube's corners
  const Data hexahedron = unstructured_mesh(xyz, Cell::hexahedron, std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 6, 7});
  CHECK(hexahedron.run("integrate").field("measure").values.get(0) == doctest::Approx(1));
  const Cells cells{std::vector<int64_t>{0, 1, 3, 4, 1, 2, 3, 6}, std::vector<int64_t>{0, 4, 8}, std::vector<uint8_t>{10, 10}};
  const Data tets = unstructured_mesh(xyz, cells);
  CHECK(tets.cell_count() == 2);
  CHECK(tets.cells().offsets.numbers() == std::vector<double>{0, 4, 8});
  CHECK(polygon_mesh(xyz, std::vector<int32_t>{0, 1, 2, 3}, std::vector<int32_t>{0, 4}).cells().types.get(0) == int(Cell::quad));
  CHECK(line_mesh(xyz, std::vector<int32_t>{0, 1, 2}, std::vector<int32_t>{0, 3}).cell_count() == 1);
  const Data mixed = surface_mesh(xyz, {.vertices = {std::vector<int32_t>{6, 7}, std::vector<int32_t>{0, 1, 2}},
                                        .polygons = {std::vector<int64_t>{0, 1, 2, 0, 2, 3, 7}, std::vector<int64_t>{0, 3, 7}},
                                        .strips = {std::vector<int32_t>{4, 5, 6, 7}, std::vector<int32_t>{0, 4}}});
  CHECK(mixed.kind() == "surface");
  CHECK(mixed.cells().types.numbers() == std::vector<double>{1, 1, 5, 9, 6});
  const Data bricks = rectilinear_grid(std::vector<double>{0, 1, 4}, std::vector<float>{0, 1}, std::vector<double>{0});
  CHECK(bricks.dims() == std::array<size_t, 3>{3, 2, 1});
  CHECK(bricks.bounds().hi == Vec3{4, 1, 0});
  CHECK(curvilinear_grid({2, 2, 1}, std::vector<double>(xyz.begin(), xyz.begin() + 12)).cell_count() == 1);
  const Data grid = uniform_grid({3, 4, 5}, {0.5, 1, 2}, {1, 1, 1});
  CHECK(grid.bounds().hi == Vec3{2, 4, 9});
  CHECK(grid.cells().offsets.count() == grid.cell_count() + 1);
  CHECK(grid.kind() == "uniform");
}

TEST_CASE("library: what cannot be is refused with what would be right") {
  const std::vector<double> xyz{0, 0, 0, 1, 0, 0, 1, 1, 0};
  CHECK(refused([&] { triangle_mesh(xyz, std::vector<int32_t>{0, 1, 7}); }).find("7") != std::string::npos);
  CHECK(refused([&] { triangle_mesh(xyz, std::vector<float>{0, 1, 2}); }).find("whole numbers") != std::string::npos);
  CHECK(refused([&] {
          surface_mesh(xyz, {.strips = {std::vector<int32_t>{0, 1, 3}, std::vector<int32_t>{0, 3}}});
        }).find("3") != std::string::npos);
  CHECK(refused([&] { point_cloud(std::vector<double>{1, 2}); }).find("points") != std::string::npos);
  CHECK(refused([&] { uniform_grid({2, 2, 2}).with_point_field("f", std::vector<float>{1, 2, 3}); }) != "");
  CHECK(refused([] { Array(std::vector<float>{1, 2, 3}, 2); }).find("tuples of 2") != std::string::npos);
  CHECK(refused([] { Data().point_count(); }).find("holds nothing") != std::string::npos);
  CHECK(refused([&] { point_cloud(xyz).dims(); }).find("'points'") != std::string::npos);
  CHECK(refused([&] { point_cloud(xyz).range("x"); }).find("not found") != std::string::npos);
  try {
    read("nowhere.vtu");
    CHECK(false);
  } catch (const Error& e) {
    CHECK(e.kind() == Error::Kind::data);
    CHECK(std::string(e.what()).find("nowhere.vtu") != std::string::npos);
  }
}

TEST_CASE("library: values of parameters take what C++ has") {
  CHECK(std::holds_alternative<bool>(Value(true).alternatives()));
  CHECK(std::holds_alternative<int64_t>(Value(size_t(3)).alternatives()));
  CHECK(std::holds_alternative<double>(Value(0.5f).alternatives()));
  CHECK(std::holds_alternative<std::string>(Value("word").alternatives()));
  CHECK(std::holds_alternative<std::vector<double>>(Value({0, 0, 0}).alternatives()));
  CHECK(std::holds_alternative<std::vector<std::string>>(Value({"a", "b"}).alternatives()));
  CHECK(std::holds_alternative<std::monostate>(Value().alternatives()));
  const Params one{{"method", "rk45"}}, two{{"method", "rk45"}, {"field", "v"}};
  CHECK(one.size() == 1);
  CHECK(two.size() == 2);
}
