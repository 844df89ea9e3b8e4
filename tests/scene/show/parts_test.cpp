// SPDX-License-Identifier: Apache-2.0
// Colours that several things in one picture share.
#include "scene/show/parts.h"

#include "scene/show/surface.h"
#include "support/test.h"

using namespace sg;

namespace {

DatasetPtr plane(double lo, double hi, const char* field = "p") {
  DatasetParts parts;
  UniformGrid g;
  g.dims = {8, 8, 1};
  parts.mesh = g;
  std::vector<double> v;
  for (int i = 0; i < 64; ++i) v.push_back(lo + (hi - lo) * i / 63);
  parts.fields.add({field, Association::point, Array::from_vector(v), "Pa", Role::scalars});
  return make_dataset(parts);
}

// The legends of several shows in one picture, each once.
std::vector<Legend> legends_of(const std::vector<std::pair<DatasetPtr, std::vector<std::string>>>& shows) {
  std::vector<ParamSet> params;
  for (const auto& s : shows) params.push_back(show_params(show_kind<SurfaceShow>(), s.second));
  std::vector<ShownParts> shown;
  for (size_t i = 0; i < shows.size(); ++i) shown.push_back({{shows[i].first}, &show_kind<SurfaceShow>(), &params[i]});
  const auto beside = colored_alike(shown);
  std::vector<Legend> legends;
  Context context;
  for (size_t i = 0; i < shown.size(); ++i) {
    Scene scene;
    for (const Legend& l : show_parts(scene, shown[i], beside[i], uint32_t(i + 1), context))
      if (std::none_of(legends.begin(), legends.end(), [&](const Legend& o) { return same_legend(o, l); })) legends.push_back(l);
  }
  return legends;
}

}  // namespace

TEST_CASE("colours: parts that have their own are drawn in them, without a scale") {
  const auto painted = [](uint8_t red) {
    DatasetParts parts = plane(0, 1)->parts();
    parts.fields = {};
    std::vector<uint8_t> rgb;
    for (int i = 0; i < 49; ++i) rgb.insert(rgb.end(), {red, 0, 9});
    parts.fields.add({"BaseColor", Association::cell, Array::from_vector(rgb, 3), "", Role::colors});
    return make_dataset(parts);
  };
  CHECK(legends_of({{painted(10), {}}, {painted(200), {}}}).empty());
  const std::vector<DatasetPtr> parts{painted(10), painted(200), plane(0, 1, "p")};
  const ParamSet params = show_params(show_kind<SurfaceShow>(), {});
  Scene scene;
  Context context;
  CHECK(show_parts(scene, {parts, &show_kind<SurfaceShow>(), &params}, {}, 1, context).empty());
  REQUIRE(scene.items.size() == 3);
  CHECK(std::get<SurfaceItem>(scene.items[0]).color_by->direct);
  CHECK(!std::get<SurfaceItem>(scene.items[2]).color_by);
}

TEST_CASE("colours: the same field of two inputs has one range and one legend") {
  const auto one = legends_of({{plane(0, 1), {}}, {plane(0.5, 4), {}}});
  REQUIRE(one.size() == 1);
  CHECK(one[0].lo == 0);
  CHECK(one[0].hi == 4);
  // Values of both signs in one of them: one map for both.
  const auto two_signs = legends_of({{plane(0, 1), {}}, {plane(-2, 0.5), {}}});
  REQUIRE(two_signs.size() == 1);
  CHECK(two_signs[0].lo == -two_signs[0].hi);
  CHECK(two_signs[0].map.name == "coolwarm");
}

TEST_CASE("colours: what is stated, and other fields, stay by themselves") {
  CHECK(legends_of({{plane(0, 1), {"range=0,2"}}, {plane(0.5, 4), {}}}).size() == 2);
  CHECK(legends_of({{plane(0, 1), {}}, {plane(0.5, 4, "T"), {}}}).size() == 2);
  const auto stated = legends_of({{plane(0, 1), {"range=0,2"}}, {plane(0.5, 4), {}}});
  CHECK(stated[0].hi == 2);
  CHECK(stated[1].lo == 0.5);
}

TEST_CASE("colours: one scale for a field that several things show in the same stated map, each its own in another one") {
  const auto legends = legends_of({{plane(0, 1), {"map=gray"}}, {plane(2, 5), {"map=gray"}}});
  REQUIRE(legends.size() == 1);
  CHECK(legends[0].lo == 0);
  CHECK(legends[0].hi == 5);
  CHECK(legends_of({{plane(0, 1), {"map=gray"}}, {plane(2, 5), {"map=viridis"}}}).size() == 2);
  CHECK(legends_of({{plane(0, 1), {"map=gray", "range=0,1"}}, {plane(2, 5), {"map=gray"}}}).size() == 2);
}
