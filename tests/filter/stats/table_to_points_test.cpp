// SPDX-License-Identifier: Apache-2.0
#include "filter/stats/table_to_points.h"

#include "support/test.h"

using namespace sg;

namespace {

Data sample() {
  auto t = std::make_shared<Table>();
  t->columns.push_back({"name", Association::whole, Array::from_vector(std::vector<int32_t>{0, 1, 0}), "", Role::none});
  t->columns.push_back({"latitude", Association::whole, Array::from_vector(std::vector<double>{10, 20, NAN}), "", Role::none});
  t->columns.push_back({"longitude", Association::whole, Array::from_vector(std::vector<double>{1, 2, 3}), "", Role::none});
  t->columns.push_back({"speed", Association::whole, Array::from_vector(std::vector<float>{7, 8, 9}), "m/s", Role::none});
  t->labels = {{"a", "b"}, {}, {}, {}};
  return TablePtr(t);
}

}  // namespace

TEST_CASE("table_to_points: usual names of coordinates are found, rows without a place left out") {
  Context ctx;
  const DatasetPtr d = table_to_points(sample(), {}, ctx);
  REQUIRE(d->point_count() == 2);
  CHECK(d->as<PointCloud>()->points.at(1) == Vec3{2, 20, 0});
  CHECK(d->fields().require("speed").array.get(1) == 8);
  CHECK(d->fields().require("speed").unit == "m/s");
  CHECK(d->fields().active()->name == "speed");
  CHECK(d->fields().require("name").role == Role::labels);
  const std::pair<std::string, std::string> names("labels of name", "0=a\n1=b");
  CHECK(d->notes() == std::vector{names});
}

TEST_CASE("table_to_points: named columns, and mistakes in them") {
  Context ctx;
  CHECK(table_to_points(sample(), {.x = "speed", .y = "longitude", .z = "speed"}, ctx)->as<PointCloud>()->points.at(2) == Vec3{9, 3, 9});
  CHECK(test::error_of([&] { table_to_points(sample(), {.x = "sped"}, ctx); }).find("did you mean 'speed'") != std::string::npos);
  CHECK(test::error_of([&] { table_to_points(sample(), {.x = "name"}, ctx); }).find("contains text") != std::string::npos);
  CHECK(test::error_of([&] {
          table_to_points(make_dataset(Mesh(PointCloud{{Array::from_vector(std::vector<float>{0, 0, 0}, 3), {}}})), {}, ctx);
        }).find("needs a table") != std::string::npos);
}

TEST_CASE("table_to_points: a line through the rows, broken where one has no place") {
  Context ctx;
  auto t = std::make_shared<Table>();
  t->columns.push_back({"t", Association::whole, Array::from_vector(std::vector<double>{0, 1, NAN, 3, 4, 5}), "s", Role::none});
  t->columns.push_back({"v", Association::whole, Array::from_vector(std::vector<double>{5, 6, 7, 8, 9, 4}), "", Role::none});
  const DatasetPtr d = table_to_points(TablePtr(t), {.x = "t", .y = "v", .line = true}, ctx);
  const auto* mesh = d->as<SurfaceMesh>();
  REQUIRE(mesh);
  const CellsView lines = cells_view(mesh->lines);
  REQUIRE(lines.count == 2);
  CHECK(lines.size(0) == 2);
  CHECK(lines.size(1) == 3);
  CHECK(mesh->points.at(size_t(lines.point(1, 0))) == Vec3{3, 8, 0});
  CHECK(mesh->points.at(size_t(lines.point(1, 2))) == Vec3{5, 4, 0});
}

TEST_CASE("table to points: columns named after the axes are one vector, those of words, places and incomplete ones are none") {
  const auto names = [](const std::vector<std::string>& columns, bool words = false, bool vectors = true) {
    auto t = std::make_shared<Table>();
    for (size_t i = 0; i < columns.size(); ++i)
      t->columns.push_back({columns[i], Association::whole, Array::from_vector(std::vector<double>{double(i), 1}), "", Role::none});
    if (words) t->labels.resize(columns.size()), t->labels.back() = {"a", "b", "c", "d"};
    Context context;
    TableToPointsParams p;
    p.vectors = vectors;
    return table_to_points(TablePtr(t), p, context);
  };
  const DatasetPtr d = names({"x", "y", "wind_x", "wind_y", "wind_z", "flat_x", "flat_y"});
  CHECK(d->fields().names() == std::vector<std::string>{"x", "y", "wind", "flat"});
  const Field& wind = d->fields().require("wind", Association::point);
  CHECK(wind.role == Role::vectors);
  CHECK(wind.components() == 3);
  for (int c = 0; c < 3; ++c) CHECK(wind.array.get(0, c) == 2 + c);
  CHECK(d->fields().require("flat", Association::point).components() == 2);
  using Names = std::vector<std::string>;
  CHECK(names({"x", "y", "a_x", "a_z"})->fields().names() == Names{"x", "y", "a_x", "a_z"});
  CHECK(names({"x", "y", "a_x", "a_y"}, true)->fields().names() == Names{"x", "y", "a_x", "a_y"});
  CHECK(names({"p_x", "p_y", "a"})->fields().names() == Names{"p_x", "p_y", "a"});
  CHECK(names({"x", "y", "a_x", "a_y", "a"})->fields().names() == Names{"x", "y", "a_x", "a_y", "a"});
  CHECK(names({"x", "y", "a_x", "a_y"}, false, false)->fields().names() == Names{"x", "y", "a_x", "a_y"});
  // ParaView's names of coordinates, wherever they stand.
  CHECK(names({"T", "Points_0", "Points_1", "Points_2"})->bounds().lo == Vec3(1, 1, 1));
  CHECK(names({"T", "Points_0", "Points_1", "Points_2"})->bounds().hi == Vec3(1, 2, 3));
}
