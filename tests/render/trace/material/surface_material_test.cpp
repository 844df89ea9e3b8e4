// SPDX-License-Identifier: Apache-2.0
#include "scene/items/surface_material.h"

#include "render/trace/material/fresnel.h"
#include "render/trace/material/material.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

TEST_CASE("materials: colours that reflect more than arrives and indices below one are refused, with what would be right") {
  auto error = [](auto change) {
    SurfaceMaterial m;
    change(m);
    return test::error_of([&] { Material{m}; });
  };
  CHECK(test::contains(error([](SurfaceMaterial& m) { m.base_color = {.5, 1.2, .5}; }), "base_color"));
  CHECK(test::contains(error([](SurfaceMaterial& m) { m.base_color = {-.1, .2, .5}; }), "base_color"));
  CHECK(test::contains(error([](SurfaceMaterial& m) { m.transmission_color = {1, 1, 1.01}; }), "transmission_color"));
  CHECK(test::contains(error([](SurfaceMaterial& m) { m.specular_ior = .8; }), "specular_ior"));
  CHECK(test::contains(error([](SurfaceMaterial& m) { m.coat_ior = .99; }), "coat_ior"));
  CHECK(test::contains(error([](SurfaceMaterial& m) { m.specular_roughness = 1.5; }), "roughness"));
  CHECK(test::contains(error([](SurfaceMaterial& m) { m.emission = {-1, 0, 0}; }), "emission"));
  CHECK(test::contains(error([](SurfaceMaterial& m) { m.base_metalness = NAN; }), "base_metalness"));
  for (const auto& p : enum_words(MaterialPreset{})) check(preset_material(p.value));
}

TEST_CASE("materials: parameters are set from words, as other parameters are") {
  SurfaceMaterial m = preset_material(MaterialPreset::gold);
  Schema schema = schema_of(m);
  set_params(schema, {"specular_roughness=0.05", "metal=copper", "base_color=0.1,0.2,0.3", "thin_walled"}, "material");
  CHECK(m.specular_roughness == .05);
  CHECK(m.metal == Metal::copper);
  CHECK(m.base_color == Vec3{.1, .2, .3});
  CHECK(m.thin_walled);
  CHECK(value_of_word<MaterialPreset>("aluminum") == MaterialPreset::aluminium);
}

TEST_CASE("materials: metals reflect about what they do at the dominant wavelengths of the primaries, 612, 549 and 464 nm (.075)") {
  struct Measured {  // Johnson, Christy; McPeak et al.: linear between their values
    MaterialPreset preset;
    Vec3 n, k;
  };
  for (const auto& [preset, n, k] : {Measured{MaterialPreset::gold, {.221, .428, 1.335}, {3.215, 2.460, 1.872}},
                                     {MaterialPreset::silver, {.059, .060, .046}, {4.111, 3.589, 2.792}},
                                     {MaterialPreset::copper, {.355, 1.016, 1.246}, {3.136, 2.579, 2.452}},
                                     {MaterialPreset::aluminium, {1.048, .786, .525}, {6.487, 5.841, 4.932}},
                                     {MaterialPreset::iron, {2.889, 2.950, 2.642}, {3.041, 2.930, 2.803}},
                                     {MaterialPreset::titanium, {2.660, 2.540, 2.303}, {3.700, 3.430, 3.079}},
                                     {MaterialPreset::chromium, {3.177, 3.180, 2.447}, {3.300, 3.330, 3.205}},
                                     {MaterialPreset::nickel, {1.986, 1.920, 1.763}, {3.989, 3.610, 3.041}}}) {
    const SurfaceMaterial described = preset_material(preset);
    CAPTURE(word_of(preset));
    const Material m(described);
    for (const float cosine : {1.f, .17f}) {
      const Vec3f f = m.metal_fresnel(cosine, {});
      for (int i = 0; i < 3; ++i) CHECK(std::abs(f[i] - fresnel_conductor(cosine, float(n[i]), float(k[i]))) < .075f);
    }
    for (int i = 0; i < 3; ++i) CHECK(described.base_color[i] == Approx(double(m.metal_fresnel(1, {})[i])).epsilon(1e-4));
  }
}

TEST_CASE("materials: the clear body has its colour at its depth, or else at the boundary; a weight of 0 takes the boundary away") {
  SurfaceMaterial described = preset_material(MaterialPreset::glass);
  described.transmission_color = {.5, .25, 1}, described.transmission_depth = 2;
  const Material deep(described);
  CHECK(std::exp(-deep.absorption().x * 2) == Approx(.5));
  CHECK(std::exp(-deep.absorption().y * 2) == Approx(.25));
  CHECK(deep.absorption().z == 0);
  CHECK(deep.shares.clear_filter == Vec3f(1, 1, 1));
  described.transmission_depth = 0;
  CHECK(Material(described).shares.clear_filter.y == .25f);
  CHECK(Material(described).absorption() == Vec3f());
  described.specular_weight = 0;
  CHECK(Material(described).ior() == 1);
  described.specular_weight = .5;
  const float eta = Material(described).ior();
  CHECK(fresnel_dielectric(1, eta).reflected() == Approx(.02).epsilon(1e-4));
}
