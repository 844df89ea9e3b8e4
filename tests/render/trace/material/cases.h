// SPDX-License-Identifier: Apache-2.0
// Materials and directions that every test of Bsdf goes through.
#pragma once
#include <string>
#include <vector>

#include "render/trace/material/bsdf.h"
#include "render/trace/sampling/sampler.h"

namespace sg::trace::test_cases {

struct Case {
  std::string name;
  SurfaceMaterial material;
  bool white = false;  ///< keeps all energy
  float opacity = 1;
  bool preset = false;
};

inline std::vector<Case> cases() {
  std::vector<Case> all;
  auto add = [&](std::string name, bool white, auto change, float opacity = 1) {
    SurfaceMaterial m;
    if (white) m.base_color = {1, 1, 1};
    change(m);
    all.push_back({std::move(name), m, white, opacity});
  };
  for (const auto& p : enum_words(MaterialPreset{}))
    all.push_back({"preset " + std::string(p.word), preset_material(p.value), false, 1, true});
  for (const double rough : {0., .2, .5, 1.}) {
    const std::string r = " of roughness " + std::to_string(rough);
    add("white plastic" + r, true, [&](SurfaceMaterial& m) { m.specular_roughness = rough; });
    add("white metal" + r, true, [&](SurfaceMaterial& m) { m.base_metalness = 1, m.specular_roughness = rough; });
    add("glass" + r, true, [&](SurfaceMaterial& m) { m.transmission_weight = 1, m.specular_roughness = rough; });
    add("thin glass" + r, true, [&](SurfaceMaterial& m) { m.transmission_weight = 1, m.thin_walled = true, m.specular_roughness = rough; });
    add("retroreflector" + r, true, [&](SurfaceMaterial& m) { m.retro_weight = 1, m.specular_roughness = rough; });
    add("coat" + r, false, [&](SurfaceMaterial& m) { m.coat_weight = .8, m.coat_roughness = rough, m.coat_color = {.9, .6, .5}; });
    add("white coat" + r, true, [&](SurfaceMaterial& m) { m.coat_weight = 1, m.coat_roughness = rough, m.specular_weight = 0; });
    add("coated mirror" + r, true, [&](SurfaceMaterial& m) { m.base_metalness = 1, m.coat_weight = .7, m.coat_roughness = rough; });
    add("mirror under smooth coat" + r, true, [&](SurfaceMaterial& m) { m.base_metalness = 1, m.coat_weight = 1; });
    add("coated retroreflector" + r, true, [&](SurfaceMaterial& m) { m.retro_weight = 1, m.coat_weight = 1, m.coat_roughness = .3; });
    add("coated glass" + r, false, [&](SurfaceMaterial& m) { m.coat_weight = .8, m.coat_roughness = rough, m.transmission_weight = 1; });
  }
  add("chromium", false, [](SurfaceMaterial& m) { m = preset_material(MaterialPreset::chromium); });
  add("white matte", true, [](SurfaceMaterial& m) { m.specular_weight = 0; });
  add("white paper", true, [](SurfaceMaterial& m) { m.specular_weight = 0, m.thin_walled = true, m.subsurface_weight = .5; });
  add("bubble", true, [](SurfaceMaterial& m) { m.transmission_weight = 1, m.specular_ior = 1; });
  add("dense glass", true, [](SurfaceMaterial& m) { m.transmission_weight = 1, m.specular_ior = 2.5, m.specular_roughness = .6; });
  add("thin air", true, [](SurfaceMaterial& m) { m.transmission_weight = 1, m.specular_ior = 1.01, m.specular_roughness = .5; });
  add("germanium", true, [](SurfaceMaterial& m) { m.transmission_weight = 1, m.specular_ior = 4, m.specular_roughness = .3; });
  add("brushed metal", false, [](SurfaceMaterial& m) { m.base_metalness = 1, m.specular_anisotropy = .8, m.specular_roughness = .5; });
  add(
      "translucent", true, [](SurfaceMaterial& m) { m.specular_roughness = .4; }, .3f);
  add("all at once", false, [](SurfaceMaterial& m) {
    m.base_metalness = .3, m.transmission_weight = .4, m.transmission_color = {.9, .5, .2}, m.retro_weight = .2, m.coat_weight = .5;
    m.coat_roughness = .3, m.specular_roughness = .6;
  });
  add(
      "all at once, thin", false,
      [](SurfaceMaterial& m) {
        m.base_metalness = .3, m.transmission_weight = .4, m.transmission_color = {.9, .5, .2}, m.retro_weight = .2, m.coat_weight = .5;
        m.coat_roughness = .3, m.specular_roughness = .6, m.thin_walled = true, m.subsurface_weight = .7;
      },
      .9f);
  return all;
}

inline Vec3f direction(double cosine, double angle) {
  const double s = std::sqrt(1 - cosine * cosine);
  return Vec3f(Vec3(s * std::cos(angle), s * std::sin(angle), cosine));
}

/// From both sides.
inline std::vector<Vec3f> directions() {
  return {direction(1, 0), direction(.8, 1), direction(.35, 2.5), direction(.06, 4), direction(-.6, 5), direction(-.2, 3)};
}

/// Shares of uniform light that go out along wo, by samples.
struct Furnace {
  Vec3 energy;
  double delta_chance = 0, nothing = 0;
};
inline Furnace furnace(const Bsdf& b, Vec3f wo, int n) {
  Furnace f;
  Sampler s(SamplerKind::sobol, 9, n);
  for (int i = 0; i < n; ++i) {
    s.start(0, 0, uint32_t(i));
    const Vec2f u = s.next2();
    const auto drawn = b.sample(wo, s.next(), u, Transport::importance);
    if (!drawn) f.nothing += 1. / n;
    else f.energy += Vec3(drawn->weight) * (1. / n), f.delta_chance += drawn->delta ? 1. / n : 0;
  }
  return f;
}

}  // namespace sg::trace::test_cases
