// SPDX-License-Identifier: Apache-2.0
// Rows and lines of collections: of all their parts.
#include "serve/renderer/questions/line.h"
#include "serve/renderer/questions/rows.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;
using doctest::Approx;

namespace {

constexpr double beside = 2;

// Two boxes side by side along x, with t = x; the right one has a field of its own.
Data two_boxes() {
  auto all = std::make_shared<Collection>();
  for (int k = 0; k < 2; ++k) {
    UniformGrid g;
    g.dims = {3, 2, 2}, g.origin = Vec3(beside * k, 0, 0);
    std::vector<float> t, own(12, 5);
    for (int i = 0; i < 12; ++i) t.push_back(float(beside * k + i % 3));
    FieldSet fields;
    fields.add({"t", Association::point, Array::from_vector(std::move(t)), "K", Role::scalars});
    if (k) fields.add({"own", Association::point, Array::from_vector(std::move(own)), "", Role::scalars});
    all->parts.push_back({k ? "right" : "left", make_dataset(g, std::move(fields))});
  }
  return CollectionPtr(all);
}

Json asked(const char* question) { return parse_json(question, "question"); }

std::string row_text(const Json& row) {
  std::string all;
  for (const Json& value : row.items()) all += value.text() + " ";
  return all;
}

}  // namespace

TEST_CASE("rows: those of all parts are counted and listed, each with the name of its part") {
  const Data data = two_boxes();
  const Json across(answer_rows(asked(R"({"on":"point","from":10,"count":4})"), data));
  CHECK(across["total"].whole() == 24);
  CHECK(row_text(across["columns"]) == "part x y z t own ");
  REQUIRE(across["rows"].size() == 4);
  CHECK(row_text(across["rows"][1]) == "left 2 1 1 2  ");
  CHECK(row_text(across["rows"][2]) == "right 2 0 0 2 5 ");
  const Json cells(answer_rows(asked(R"({"on":"cell","from":1,"count":9})"), data));
  CHECK(cells["total"].whole() == 4);
  CHECK(row_text(cells["columns"]) == "part ");
  CHECK(cells["rows"].size() == 3);
  CHECK(answer_rows(asked(R"({"on":"point","from":24,"count":9})"), data)[2].second.size() == 0);
  const Json alone(answer_rows(asked(R"({"on":"point","from":0,"count":1})"), std::get<CollectionPtr>(data)->parts[0].data));
  CHECK(row_text(alone["columns"]) == "x y z t ");
}

TEST_CASE("line: it is sampled through all parts, and a field need not be in each of them") {
  const Data data = two_boxes();
  Context context;
  const Json line(answer_line(asked(R"({"field":"t","from":[-1,0.5,0.5],"to":[5,0.5,0.5],"count":13})"), data, context));
  CHECK(line["unit"].text() == "K");
  REQUIRE(line["values"].size() == 13);
  for (size_t i = 0; i < 13; ++i) {
    const double x = -1 + 0.5 * double(i);
    CAPTURE(x);
    CHECK(line["distance"][i].number() == Approx(x + 1));
    if (x < 0 || x > 4) CHECK(line["values"][i].is_null());
    else CHECK(line["values"][i].number() == Approx(x));
  }
  const Json own(answer_line(asked(R"({"field":"own","from":[0.5,0.5,0.5],"to":[3.5,0.5,0.5],"count":2})"), data, context));
  CHECK(own["values"][0].is_null());
  CHECK(own["values"][1].number() == 5);
  CHECK_THROWS_AS(answer_line(asked(R"({"field":"wool","from":[0,0,0],"to":[1,0,0],"count":2})"), data, context), Error);
}

TEST_CASE("line: of clouds the nearest point of all has the value") {
  auto all = std::make_shared<Collection>();
  for (int k = 0; k < 2; ++k) {
    PointCloud cloud;
    cloud.points.xyz = Array::from_vector(std::vector<double>{10.0 * k, 0, 0}, 3);
    FieldSet fields;
    fields.add({"q", Association::point, Array::from_vector(std::vector<double>{double(k + 1)}), "", Role::scalars});
    all->parts.push_back({std::to_string(k), make_dataset(cloud, std::move(fields))});
  }
  Context context;
  const Json line(answer_line(asked(R"({"field":"q","from":[1,0,0],"to":[9,0,0],"count":2})"), CollectionPtr(all), context));
  CHECK(line["values"][0].number() == 1);
  CHECK(line["values"][1].number() == 2);
}
