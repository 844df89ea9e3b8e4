// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/seen_outside.h"

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
  CHECK(look.prepare.empty());
  CHECK(look.reason.find("lie inside") != std::string::npos);
  // With a face upon the solids, which must not hide them where they are cut.
  UnstructuredMesh mixed = *nested->as<UnstructuredMesh>();
  const Array solid = mixed.cells.connectivity;
  std::vector<int32_t> ids, offsets{0}, material;
  std::vector<uint8_t> types;
  for (size_t c = 0; c <= nested->cell_count(); ++c) {
    const bool face = c == nested->cell_count();
    for (size_t k = 0; k < (face ? 4u : 8u); ++k) ids.push_back(int32_t(solid.get(face ? k : 8 * c + k)));
    offsets.push_back(int32_t(ids.size())), types.push_back(uint8_t(face ? CellType::quad : mixed.type(c)));
    material.push_back(face ? 3 : int32_t(nested->fields().require("material").array.get(c)));
  }
  mixed.cells = {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  mixed.types = Array::from_vector(std::move(types));
  FieldSet fields;
  fields.add({"material", Association::cell, Array::from_vector(std::move(material)), "", Role::labels});
  const DatasetPtr with_face = make_dataset(std::move(mixed), std::move(fields));
  Look solids = choose_look(*with_face, "", "");
  cut_open(solids, with_face, "", context);
  REQUIRE(solids.prepare.size() == 2);
  CHECK(solids.prepare[0] == "extract");
  CHECK(solids.prepare[1].starts_with("types="));
  CHECK(solids.prepare[1].find("Quad") == std::string::npos);
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
