// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/seen_outside.h"

#include <algorithm>
#include <cmath>

#include "filter/mesh/to_unstructured.h"
#include "scene/look/look.h"
#include "support/test.h"

using namespace sg;

namespace {

// Hexahedra over [-1, 1]^2 x [-longer, longer] with f at their points.
DatasetPtr block(double (*f)(Vec3), double longer = 1) {
  UniformGrid g;
  g.dims = {9, 9, 9}, g.origin = {-1, -1, -longer}, g.spacing = {0.25, 0.25, 0.25 * longer};
  std::vector<double> v;
  for (size_t i = 0; i < 729; ++i)
    v.push_back(f({-1 + 0.25 * double(i % 9), -1 + 0.25 * double(i / 9 % 9), (-1 + 0.25 * double(i / 81)) * longer}));
  DatasetParts p;
  p.mesh = g;
  p.fields.add({"f", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  Context context;
  return to_unstructured(make_dataset(std::move(p)), {}, context);
}
double bubble(Vec3 x) { return std::max(0.0, (1 - x.x * x.x) * (1 - x.y * x.y) * (1 - x.z * x.z)); }  // zero all over the outside
double slope(Vec3 x) { return x.x; }

}  // namespace

TEST_CASE("seen outside: a field that is zero on all faces tells only inside") {
  Context context;
  const DatasetPtr hidden = block(bubble), shown = block(slope);
  CHECK(tells_only_inside(hidden, hidden->fields().require("f"), context));
  CHECK_FALSE(tells_only_inside(shown, shown->fields().require("f"), context));
}

TEST_CASE("seen outside: a part that is only inside is not seen, parts that all reach the outside are") {
  Context context;
  const auto parts = [&](bool (*first)(Vec3)) {
    DatasetParts p;
    UniformGrid g;
    g.dims = {9, 9, 9}, g.origin = {-1, -1, -1}, g.spacing = {0.25, 0.25, 0.25};
    std::vector<int32_t> v;
    for (int i = 0; i < 512; ++i)
      v.push_back(first({0.25 * (i % 8) - 0.875, 0.25 * (i / 8 % 8) - 0.875, 0.25 * double(i / 64) - 0.875}) ? 1 : 2);
    p.mesh = g;
    p.fields.add({"material", Association::cell, Array::from_vector(std::move(v)), "", Role::labels});
    return to_unstructured(make_dataset(std::move(p)), {}, context);
  };
  const DatasetPtr nested = parts([](Vec3 x) {
    return std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) < 0.5;
  }),
                   beside = parts([](Vec3 x) { return x.x < 0; });
  CHECK(tells_only_inside(nested, nested->fields().require("material"), context));
  CHECK_FALSE(tells_only_inside(beside, beside->fields().require("material"), context));
  Look look = choose_look(*nested, "", "");
  cut_open(look, nested, "", context);
  REQUIRE(look.filter.size() == 2);
  CHECK(look.filter[0] == "clip");
  CHECK(look.reason.find("lie inside") != std::string::npos);
}

TEST_CASE("cut_open: such a solid is cut across the line of sight, a long one lengthwise") {
  Context context;
  for (const double longer : {1.0, 4.0}) {
    const DatasetPtr d = block(bubble, longer);
    Look look = choose_look(*d, "", "");
    cut_open(look, d, "", context);
    REQUIRE(look.filter.size() == 2);
    CHECK(look.filter[0] == "clip");
    if (longer > 1) CHECK(look.filter[1] != "axis=z");
    CHECK_FALSE(look.shows.at(0).of_input);
    CHECK(look.reason.find("cut open") != std::string::npos);
  }
  const DatasetPtr d = block(slope);
  Look look = choose_look(*d, "", "");
  cut_open(look, d, "", context);
  CHECK(look.filter.empty());
}
