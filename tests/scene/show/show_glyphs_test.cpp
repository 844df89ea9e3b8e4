// SPDX-License-Identifier: Apache-2.0
#include "scene/show/glyphs.h"

#include "scene/show/show.h"
#include "support/test.h"

using namespace sg;
using sg::test::error_of;

namespace {

// A flat field of 30 x 20 points in degrees over southern Africa: wind to the east, growing northwards.
DatasetPtr wind() {
  UniformGrid g;
  g.dims = {30, 20, 1}, g.origin = {10, -35, 0}, g.spacing = {1, 1, 1};
  std::vector<float> v, t;
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 30; ++i) v.insert(v.end(), {float(j), 0}), t.push_back(float(i));
  FieldSet f;
  f.add({"wind", Association::point, Array::from_vector(std::move(v), 2), "m/s", Role::vectors});
  f.add({"t", Association::point, Array::from_vector(std::move(t)), "K", Role::scalars});
  return make_dataset(Mesh(g), std::move(f));
}

GlyphsItem item_of(const std::vector<std::string>& words, std::optional<Legend>* legend = nullptr, Scene scene = {}) {
  Context context;
  const auto shown = add_show(scene, "glyphs", wind(), words, context);
  if (legend) *legend = shown;
  return std::get<GlyphsItem>(scene.items.back());
}

}  // namespace

TEST_CASE("show glyphs: flat arrows coloured by their length, whose legend tells their scale") {
  std::optional<Legend> legend;
  GlyphsItem item = item_of({}, &legend);
  CHECK(item.rule.size == GlyphRule::Size::length);
  CHECK(item.rule.normal == Vec3{0, 0, 1});
  CHECK_FALSE(item.material.lit);
  REQUIRE(item.color_by);
  CHECK(item.color_by->field == "wind");
  REQUIRE(legend);
  CHECK(legend->title == "wind magnitude");
  REQUIRE(legend->glyph);
  CHECK(legend->glyph->most == doctest::Approx(19));
  CHECK(legend->glyph->length == doctest::Approx(item.rule.scale));
  CHECK(legend->glyph->points);
  CHECK_FALSE(legend->glyph->in_pixels);
  Scene scene;
  scene.items.emplace_back(item);
  CHECK(scene_bounds(scene).hi.x > 39);  // the last arrow begins at the end of the data
  item = item_of({"field=t", "shape=cone", "opacity=0.5"}, &legend);
  CHECK(item.color_by->field == "t");
  CHECK(item.opacity == 0.5);
  CHECK(item.material.lit);
  CHECK_FALSE(item_of({"color=red"}, &legend).color_by);
  CHECK_FALSE(legend);
}

TEST_CASE("show glyphs: barbs have sizes in pixels and the strokes of their hemisphere; on a coloured map flat arrows have one colour") {
  const GlyphsItem barbs = item_of({"shape=barbs", "size=20"});
  CHECK(barbs.in_pixels);
  CHECK(barbs.rule.scale == 20);
  CHECK_FALSE(barbs.color_by);
  const Array& shape = barbs.data->fields().require("barb").array;
  double least = 1e9, most = 0;
  for (size_t i = 0; i < shape.count(); ++i)
    if (shape.get(i) > 0) least = std::min(least, shape.get(i)), most = std::max(most, shape.get(i));
  CHECK(least > 100);  // all of them south of the equator
  CHECK(most <= 100 + 37 / 5 + 1);
  Scene map;
  Context context;
  add_show(map, "surface", wind(), {"field=t"}, context);
  CHECK_FALSE(item_of({}, nullptr, map).color_by);
  CHECK(error_of([] { item_of({"shape=barb"}); }).find("did you mean 'barbs'") != std::string::npos);
  CHECK(error_of([] { item_of({"field=nothing"}); }).find("'nothing'") != std::string::npos);
  CHECK(error_of([] { show_params(find_show("glyphs"), {"shap=arrow"}); }).find("shape") != std::string::npos);
}
