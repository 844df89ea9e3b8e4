// SPDX-License-Identifier: Apache-2.0
#include "scene/show/surface.h"

#include "scene/show/show.h"
#include "support/test.h"

using namespace sg;

namespace {

// A box of 2 x 1 x 1 cells with a field on its cells and one on its points.
DatasetPtr box() {
  DatasetParts parts;
  UniformGrid g;
  g.dims = {3, 2, 2};
  parts.mesh = g;
  std::vector<float> at_points(12);
  for (size_t i = 0; i < 12; ++i) at_points[i] = float(i % 3);
  parts.fields.add({"p", Association::point, Array::from_vector(at_points), "Pa", Role::scalars});
  parts.fields.add({"c", Association::cell, Array::from_vector<float>({1, 3}), "", Role::none});
  return make_dataset(parts);
}

Scene shown(const std::vector<std::string>& words, std::optional<Legend>* legend = nullptr) {
  Scene scene;
  Context context;
  const ParamSet params = show_params(show_kind<SurfaceShow>(), words);
  const auto made = add(scene, box(), params.as<SurfaceShow>(), context);
  if (legend) *legend = made;
  return scene;
}

}  // namespace

TEST_CASE("surface style: a wireframe is every edge once, coloured like the surface") {
  std::optional<Legend> legend;
  const Scene scene = shown({"style=wireframe", "field=p"}, &legend);
  REQUIRE(scene.items.size() == 1);
  const auto& lines = std::get<LinesItem>(scene.items[0]);
  // Of two boxes side by side: 12 + 12 - 4.
  CHECK(lines.data->as<SurfaceMesh>()->lines.size() == 20);
  CHECK(lines.data->as<SurfaceMesh>()->polygons.size() == 0);
  REQUIRE(lines.color_by);
  CHECK(lines.color_by->field == "p");
  REQUIRE(legend);
  CHECK(legend->hi == 2);
}

TEST_CASE("surface style: cell fields are averaged to the points of a wireframe and of points") {
  for (const char* style : {"style=wireframe", "style=points"}) {
    const Scene scene = shown({style, "field=c"});
    REQUIRE(scene.items.size() == 1);
    std::visit(
        [&](const auto& item) {
          if constexpr (requires {
                          item.color_by;
                          item.data;
                        }) {
            REQUIRE(item.color_by);
            CHECK(item.color_by->association == Association::point);
            const Field& f = item.data->fields().require("c", Association::point);
            const Range r = item.data->range(f);
            CHECK(r.lo == 1);
            CHECK(r.hi == 3);
          }
        },
        scene.items[0]);
  }
  CHECK(std::holds_alternative<PointsItem>(shown({"style=points", "color=red"}).items[0]));
}
