// SPDX-License-Identifier: Apache-2.0
#include "scene/look/look.h"
#include "scene/show/surface.h"
#include "support/test.h"

using namespace sg;

namespace {

// Two strips of 10 quads each: one whose thickness varies from 1 to 2, one of a single thickness.
DatasetPtr strips(double rigid) {
  std::vector<float> xyz;
  std::vector<int32_t> ids;
  std::vector<double> thickness;
  for (const bool second : {false, true})
    for (int i = 0; i < 11; ++i)
      for (int j = 0; j < 2; ++j) {
        xyz.insert(xyz.end(), {float(i), float(j), second ? 3.0f : 0.1f * float(i * i)});
        thickness.push_back(second ? rigid : 1 + 0.1 * i);
        if (i < 10 && j == 0) {
          const int32_t a = int32_t(thickness.size()) - 1;
          ids.insert(ids.end(), {a, a + 2, a + 3, a + 1});
        }
      }
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.polygons = {Array::from_vector(std::move(ids)), {}, 4};
  DatasetParts parts;
  parts.mesh = m;
  parts.fields.add({"thickness", Association::point, Array::from_vector(std::move(thickness)), "", Role::scalars});
  return make_dataset(std::move(parts));
}

Look look_at(const DatasetPtr& d, const std::string& field = "") {
  Context context;
  Look look = choose_look(*d, field, "case");
  show_rigid(look, {&d, 1}, field, context);
  return look;
}

}  // namespace

TEST_CASE("rigid pieces: what has one value alone beyond all others takes no colours from them") {
  const Look above = look_at(strips(5));
  CHECK(above.filter == std::vector<std::string>{"threshold", "field=thickness", "min=5", "invert=true"});
  REQUIRE(above.shows.size() == 2);
  CHECK_FALSE(above.shows[0].of_input);
  CHECK(above.shows[1].filter == std::vector<std::string>{"threshold", "field=thickness", "min=5"});
  CHECK(above.shows[1].params.as<SurfaceShow>().opacity < 0.5);
  CHECK(above.reason.find("'thickness'") != std::string::npos);
  CHECK(look_at(strips(0)).filter == std::vector<std::string>{"threshold", "field=thickness", "max=0", "invert=true"});
}

TEST_CASE("rigid pieces: one value among the others, or a field that was asked for, changes nothing") {
  CHECK(look_at(strips(1.55)).filter.empty());
  CHECK(look_at(strips(5), "thickness").filter.empty());
}
