// SPDX-License-Identifier: Apache-2.0
#include "scene/show/texture_color.h"

#include "data/fields/known_looks.h"
#include "scene/show/show.h"
#include "support/test.h"

using namespace sg;

namespace {

// Four by one cells: a field that rises along x, and a texture.
DatasetPtr strip(const char* name, std::vector<float> texture) {
  UniformGrid g;
  g.dims = {5, 2, 1};
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::vector<float>{0, 1, 2, 3, 4, 0, 1, 2, 3, 4}), "", Role::none});
  f.add({name, Association::point, Array::from_vector(std::move(texture)), "", Role::none, known_look(name)});
  return make_dataset(g, f);
}

const SurfaceItem& shown(Scene& scene, const DatasetPtr& d, std::vector<std::string> words) {
  Context c;
  add_show(scene, "surface", d, words, c);
  return std::get<SurfaceItem>(scene.items.back());
}

double grey(const SurfaceItem& item, size_t point) {
  const Array& a = item.data->fields().require(item.color_by->field).array;
  return a.get(point, 0) + a.get(point, 1) + a.get(point, 2);
}

}  // namespace

TEST_CASE("texture: a field 'lic' darkens and brightens the colours of another, which the legend shows") {
  const DatasetPtr d = strip("lic", {0, 0.25, 0.5, 0.75, 1, 0, 0.25, 0.5, 0.75, 1});
  Scene scene;
  const SurfaceItem& item = shown(scene, d, {"color=#808080"});
  REQUIRE(item.color_by);
  CHECK(item.color_by->direct);
  for (size_t i = 0; i + 1 < 5; ++i) CHECK(grey(item, i) < grey(item, i + 1));
  CHECK(grey(item, 2) == doctest::Approx(3 * 128).epsilon(0.05));  // the middle leaves the colour as it is
  // Coloured by 'v': the texture is no candidate for the colours.
  CHECK(automatic_field(*d)->name == "v");
  Context c;
  CHECK(add_show(scene, "surface", d, {}, c).has_value());
  CHECK(std::get<SurfaceItem>(scene.items.back()).color_by->direct);
  // As the colour itself it is no texture.
  CHECK(!shown(scene, d, {"field=lic"}).color_by->direct);
  CHECK(!shown(scene, d, {"texture=none"}).color_by->direct);
}

TEST_CASE("texture: of both signs, with holes, by name, and wrong ones") {
  Scene scene;
  const DatasetPtr signs = strip("spot noise", {-0.5f, -0.25f, 0, 0.25f, 0.5f, NAN, NAN, NAN, NAN, NAN});
  const SurfaceItem& item = shown(scene, signs, {"color=#808080"});
  CHECK(grey(item, 0) < 0.3 * 384);
  CHECK(grey(item, 2) == doctest::Approx(384).epsilon(0.05));
  CHECK(grey(item, 7) == doctest::Approx(384).epsilon(0.01));
  const DatasetPtr other = strip("pattern", {0, 1, 0, 1, 0, 1, 0, 1, 0, 1});
  CHECK(!shown(scene, other, {"field=v"}).color_by->direct);
  CHECK(shown(scene, other, {"field=v", "texture=pattern"}).color_by->direct);
  CHECK(test::error_of([&] { shown(scene, other, {"texture=patern"}); }).find("did you mean 'pattern'") != std::string::npos);
}
