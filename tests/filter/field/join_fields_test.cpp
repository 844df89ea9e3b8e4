// SPDX-License-Identifier: Apache-2.0
#include "filter/field/join_fields.h"

#include "support/test.h"

using namespace sg;

namespace {

DatasetPtr grid(size_t n, std::vector<std::pair<std::string, double>> fields, Vec3 origin = {}) {
  UniformGrid g;
  g.dims = {n, 2, 1};
  g.origin = origin;
  DatasetParts parts;
  parts.mesh = g;
  for (const auto& [name, value] : fields)
    parts.fields.add({name, Association::point, Array::from_vector(std::vector<double>(2 * n, value)), "m/s", Role::none});
  return make_dataset(std::move(parts));
}

DatasetPtr join(const std::vector<Data>& inputs, JoinFieldsParams p = {}, std::vector<std::string>* told = nullptr) {
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) {
    if (told) told->emplace_back(text);
  };
  return std::get<DatasetPtr>(join_fields(inputs, p, context));
}

}  // namespace

TEST_CASE("join_fields: fields of further inputs come onto the first mesh, with their units") {
  const DatasetPtr all = join({grid(3, {{"u", 1}, {"lat", 7}}), grid(3, {{"v", 2}, {"lat", 7}}), grid(3, {{"w", 3}, {"lat", 8}})});
  CHECK(all->fields().names() == std::vector<std::string>{"u", "lat", "v", "w", "lat_3"});
  CHECK(all->fields().require("v").array.get(5) == 2);
  CHECK(all->fields().require("v").unit == "m/s");
  CHECK(all->fields().require("lat").array.get(0) == 7);
  CHECK(all->fields().require("lat_3").array.get(0) == 8);
}

TEST_CASE("join_fields: chosen fields under other names") {
  JoinFieldsParams p;
  p.fields = {"b", "a"}, p.names = {"second", "first"};
  const DatasetPtr all = join({grid(3, {{"u", 1}}), grid(3, {{"a", 2}, {"b", 3}, {"c", 4}})}, p);
  CHECK(all->fields().names() == std::vector<std::string>{"u", "first", "second"});
  CHECK(all->fields().require("second").array.get(0) == 3);
}

TEST_CASE("join_fields: hidden in one is hidden, and places that differ are told") {
  DatasetParts parts = grid(3, {{"v", 2}}, {0.1, 0, 0})->parts();
  parts.cell_ghost = Array::from_vector(std::vector<uint8_t>{ghost_hidden_cell, 0});
  std::vector<std::string> told;
  const DatasetPtr all = join({grid(3, {{"u", 1}}), make_dataset(std::move(parts))}, {}, &told);
  CHECK(all->cell_ghost().get(0) == ghost_hidden_cell);
  REQUIRE(told.size() == 1);
  CHECK(told[0].find("lie up to 0.1 away from those of the first") != std::string::npos);
  CHECK(all->bounds().lo.x == 0);
}

TEST_CASE("join_fields: collections part by part") {
  const auto both = [](DatasetPtr a, DatasetPtr b) {
    Collection c;
    c.parts = {{"a", a}, {"b", b}};
    return std::make_shared<const Collection>(c);
  };
  Context context;
  const Data all =
      join_fields({both(grid(2, {{"u", 1}}), grid(3, {{"u", 2}})), both(grid(2, {{"v", 3}}), grid(3, {{"v", 4}}))}, {}, context);
  double sum = 0;
  for_each_dataset(all, [&](const std::string&, const DatasetPtr& d) { sum += d->fields().require("v").array.get(0); });
  CHECK(sum == 7);
  CHECK(test::error_of([&] {
          join_fields({both(grid(2, {}), grid(2, {})), grid(2, {{"v", 1}})}, {}, context);
        }).find("input 2 has 1 parts, the first has 2") != std::string::npos);
}

TEST_CASE("join_fields: other meshes, missing fields and names are refused") {
  const auto message = [](const std::vector<Data>& in, JoinFieldsParams p = {}) { return test::error_of([&] { join(in, p); }); };
  CHECK(message({grid(3, {}), grid(4, {{"v", 1}})})
            .find("input 2 has a different mesh: uniform of 4 x 2 x 1, 8 points, 3 cells; the first has uniform of 3 x 2 x 1, 6 points, 2 "
                  "cells") != std::string::npos);
  JoinFieldsParams p;
  p.fields = {"velociti"};
  CHECK(message({grid(3, {}), grid(3, {{"velocity", 1}})}, p).find("did you mean 'velocity'") != std::string::npos);
  p.names = {"a", "b"};
  CHECK(message({grid(3, {}), grid(3, {{"velocity", 1}})}, p).find("2 names for 1 fields") != std::string::npos);
  CHECK(message({grid(3, {}), std::make_shared<const Table>()}).find("input 2 is a table") != std::string::npos);
}
