// SPDX-License-Identifier: Apache-2.0
// The words for what a surface is made of: each reaches its number, and fields multiply them.
#include "scene/show/material_words.h"

#include "base/schema/value.h"
#include "image/image.h"
#include "scene/items/surface_pictures.h"
#include "scene/show/show.h"
#include "scene/show/surface.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;

namespace {

// A square with fields on its points: "part" from 0 to 1, "wide" from -1 to 2.
DatasetPtr square_with_parts() {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
  m.polygons.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 3}), m.polygons.fixed = 4;
  DatasetParts parts;
  parts.mesh = m;
  parts.fields.add({"part", Association::point, Array::from_vector(std::vector<float>{0, 1, 1, 0}), "", Role::scalars});
  parts.fields.add({"wide", Association::point, Array::from_vector(std::vector<float>{-1, 2, 2, -1}), "", Role::none});
  return make_dataset(parts);
}

struct WithWords {
  SurfaceItem item;
  std::string warnings;
};
WithWords drawn_with(const std::vector<std::string>& words) {
  Context context;
  WithWords s;
  context.on_log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) s.warnings += text;
  };
  Scene scene;
  add_show(scene, "surface", square_with_parts(), words, context);
  s.item = std::get<SurfaceItem>(scene.items.at(0));
  return s;
}
SurfaceMaterial matter_with(const std::vector<std::string>& words) { return drawn_with(words).item.made_of.value(); }

}  // namespace

TEST_CASE("material words: each number of a material has its word, which takes the place of what the preset says") {
  // All but the base colour, which is the surface's, and the anisotropy of highlights, which wants a direction.
  const std::vector<std::pair<std::string, std::string>> words = {
      {"metal", "copper"},
      {"base_metalness", "0.25"},
      {"specular_weight", "0.125"},
      {"specular_roughness", "0.75"},
      {"specular_ior", "1.25"},
      {"transmission_weight", "0.375"},
      {"transmission_color", "0.5,0.25,1"},
      {"transmission_depth", "2"},
      {"subsurface_weight", "0.625"},
      {"subsurface_radius", "1,2,3"},
      {"subsurface_anisotropy", "-0.5"},
      {"coat_weight", "0.875"},
      {"coat_color", "1,0.5,0.25"},
      {"coat_roughness", "0.0625"},
      {"coat_ior", "1.75"},
      {"retro_weight", "0.1875"},
      {"dielectric_priority", "3"},
      {"emission", "0.5,4,2"},
      {"thin_walled", "true"},
  };
  SurfaceMaterial m;
  const Schema all = schema_of(m);
  CHECK(all.decls().size() == words.size() + 2);
  std::vector<std::string> stated{"material=car_paint"};
  for (const auto& [name, value] : words) {
    CAPTURE(name);
    // Alone, and beside all others.
    SurfaceMaterial alone = matter_with({"material=car_paint", name + "=" + value});
    stated.push_back(name + "=" + value);
    SurfaceMaterial before = preset_material(MaterialPreset::car_paint);
    const auto text = [&](SurfaceMaterial& of) {
      for (Schema s = schema_of(of); const ParamDecl& d : s.decls())
        if (d.name == name) return value_text(d.ref.get());
      return std::string();
    };
    CHECK(text(alone) == value);
    CHECK(text(before) != value);
  }
  SurfaceMaterial together = matter_with(stated);
  for (Schema s = schema_of(together); const ParamDecl& d : s.decls())
    for (const auto& [name, value] : words)
      if (d.name == name) CHECK_MESSAGE(value_text(d.ref.get()) == value, name);
}

TEST_CASE("material words: values out of their ranges, and metals that are none, are refused") {
  const auto refused = [](const std::string& word) { return test::error_of([&] { drawn_with({word}); }); };
  for (const char* word : {"specular_weight=1.5", "subsurface_anisotropy=1", "coat_color=0.5,0.5,2", "coat_ior=0.9", "retro_weight=-1"})
    CHECK_MESSAGE(test::contains(refused(word), std::string(word).substr(0, std::string(word).find('='))), word);
  CHECK(test::contains(refused("metal=gald"), "gold"));
}

TEST_CASE("material words: a metal is all of the surface where nothing says how much, and has its colour there") {
  for (const auto& [word, metal] : enum_words(Metal{})) {
    CAPTURE(word);
    const WithWords s = drawn_with({"metal=" + std::string(word)});
    const SurfaceMaterial preset = preset_material(value_of_word<MaterialPreset>(word).value());
    CHECK(s.item.made_of->metal == metal);
    CHECK(s.item.made_of->base_metalness == 1);
    CHECK(s.item.made_of->base_color == preset.base_color);
    CHECK_FALSE(s.item.color_by);
    CHECK(double(s.item.color.x) == Approx(double(srgb_encode(float(preset.base_color.x)))));
  }
  CHECK(drawn_with({"metal=gold", "field=part"}).item.color_by->field == "part");
  CHECK(matter_with({"metal=gold", "base_metalness=0.5"}).base_metalness == 0.5);
  CHECK(matter_with({"metal=gold", "material=car_paint"}).base_metalness == 0.5);
  CHECK(matter_with({"metal=gold", "material=car_paint"}).base_color == preset_material(MaterialPreset::car_paint).base_color);
  CHECK(matter_with({"metal=gold", "material=retroreflector"}).base_metalness == 0);
  CHECK(matter_with({"metal=gold", "base_metalness_by=part"}).base_metalness == 1);
}

TEST_CASE("material words: a field of the coat's roughness decides it alone, or multiplies what is stated") {
  const WithWords alone = drawn_with({"coat_weight=1", "coat_roughness_by=part"});
  CHECK(alone.item.made_of->coat_roughness == 1);
  REQUIRE(alone.item.pictures->factors.size() == 1);
  CHECK(alone.item.pictures->factors[0].channels[0].factor == MaterialFactor::coat_roughness);
  CHECK(alone.item.pictures->factors[0].picture.coordinates == "part");
  CHECK(alone.warnings.empty());
  CHECK(matter_with({"coat_weight=1", "coat_roughness=0.5", "coat_roughness_by=part"}).coat_roughness == 0.5);
  CHECK(test::contains(drawn_with({"coat_weight=1", "coat_roughness_by=wide"}).warnings, "coat_roughness_by=wide"));
  CHECK(test::contains(test::error_of([] { drawn_with({"coat_roughness_by=nothing"}); }), "nothing"));
}

TEST_CASE("material words: lines, points and glyphs are made of what is stated, too, in its own colour unless a field is named") {
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::vector<float>{1, 0, 0, 0, 2, 0}, 3), "", Role::vectors});
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0}, 3);
  m.lines.connectivity = Array::from_vector(std::vector<int32_t>{0, 1}), m.lines.fixed = 2;
  const DatasetPtr data = make_dataset(Mesh(m), std::move(f));
  const Vec3f copper = own_color(preset_material(MaterialPreset::copper));
  for (const char* kind : {"lines", "points", "glyphs"}) {
    CAPTURE(kind);
    Context context;
    const auto with = [&](const std::vector<std::string>& words, auto&& check) {
      Scene scene;
      add_show(scene, kind, data, words, context);
      std::visit([&](const auto& item) { check(item); }, scene.items.at(0));
    };
    with({"material=copper"}, [&](const auto& item) {
      REQUIRE(item.made_of);
      if constexpr (requires {
                      item.color_by;
                      item.color.x;
                    }) {
        CHECK(item.color == copper);
        CHECK(!item.color_by);
      }
    });
    with({"material=copper", "field=v"}, [&](const auto& item) {
      if constexpr (requires { item.color_by; }) CHECK(item.color_by);
    });
    with({"specular_roughness=0.1"}, [&](const auto& item) { CHECK(item.made_of->specular_roughness == 0.1); });
    with({}, [&](const auto& item) { CHECK(!item.made_of); });
  }
}
