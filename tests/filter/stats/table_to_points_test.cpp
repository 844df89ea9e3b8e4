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
  CHECK(table_to_points(sample(), {"speed", "longitude", "speed"}, ctx)->as<PointCloud>()->points.at(2) == Vec3{9, 3, 9});
  CHECK(test::error_of([&] { table_to_points(sample(), {"sped", "", ""}, ctx); }).find("did you mean 'speed'") != std::string::npos);
  CHECK(test::error_of([&] { table_to_points(sample(), {"name", "", ""}, ctx); }).find("contains text") != std::string::npos);
  CHECK(test::error_of([&] {
          table_to_points(make_dataset(Mesh(PointCloud{{Array::from_vector(std::vector<float>{0, 0, 0}, 3), {}}})), {}, ctx);
        }).find("needs a table") != std::string::npos);
}
