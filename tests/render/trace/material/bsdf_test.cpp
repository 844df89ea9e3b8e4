// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/bsdf.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "render/trace/material/cases.h"
#include "render/trace/sampling/warp.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test_cases;
using doctest::Approx;

TEST_CASE("bsdf: the weight of a sample is f |cos| / pdf, its direction is unit, and it says on which side it is") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const Material material(c.material);
    const Bsdf b = make_bsdf(material, material.base_color(), c.opacity);
    for (const Vec3f wo : directions())
      for (const Transport t : {Transport::radiance, Transport::importance})
        for (uint64_t i = 0; i < 200; ++i) {
          const auto unit = [&](uint64_t k) { return std::min(float(random_unit(i, k)), 0x1.fffffep-1f); };
          const auto s = b.sample(wo, unit(0), {unit(1), unit(2)}, t);
          if (!s) continue;
          CHECK(length(s->direction) == Approx(1).epsilon(1e-5));
          CHECK(s->transmitted == (s->direction.z * wo.z < 0));
          CHECK(s->pdf > 0);
          CHECK(s->weight.x >= 0);
          if (!s->transmitted || material.thin()) CHECK(s->eta == 1);
          if (s->delta) continue;
          CHECK(b.pdf(wo, s->direction) == Approx(double(s->pdf)).epsilon(1e-3));
          const Vec3f weight = b.evaluate(wo, s->direction, t) * (std::abs(s->direction.z) / s->pdf);
          for (int k = 0; k < 3; ++k) CHECK(weight[k] == Approx(double(s->weight[k])).epsilon(2e-3));
        }
  }
}

TEST_CASE("bsdf: nothing is infinite or no number at grazing angles, along the axes and at the ends of the random numbers") {
  const float last = 0x1.fffffep-1f;
  std::vector<Vec3f> all{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const double z : {1e-7, 1e-4, 1e-2, .9999999}) all.insert(all.end(), {direction(z, 1), direction(-z, 1), direction(z, 1 + M_PI)});
  auto sound = [](Vec3f v) { return v.x >= 0 && v.y >= 0 && v.z >= 0 && std::isfinite(v.x + v.y + v.z); };
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const Material material(c.material);
    const Bsdf b = make_bsdf(material, material.base_color(), c.opacity);
    for (const Vec3f wo : all) {
      CAPTURE(wo.z);
      CHECK(sound(b.albedo(wo)));
      for (const Vec3f wi : all) {
        CHECK(sound(b.evaluate(wo, wi)));
        CHECK((b.pdf(wo, wi) >= 0 && std::isfinite(b.pdf(wo, wi))));
      }
      for (const float choice : {0.f, .2f, .4f, .6f, .8f, last})
        for (const Vec2f u : {Vec2f{0, 0}, {last, last}, {0, last}, {last, 0}, {.5f, .5f}}) {
          const auto s = b.sample(wo, choice, u);
          if (!s) continue;
          CHECK((sound(s->weight) && std::isfinite(s->pdf) && std::abs(length(s->direction) - 1) < 1e-5f));
        }
    }
  }
}

TEST_CASE("bsdf: no kind gives back more than arrives from any direction, and white ones all of it") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const Material material(c.material);
    const Bsdf b = make_bsdf(material, material.base_color(), c.opacity);
    for (const Vec3f wo : directions()) {
      CAPTURE(wo.z);
      const Vec3 energy = furnace(b, wo, 32768).energy;
      for (int k = 0; k < 3; ++k) {
        CHECK(energy[k] < 1.005);
        if (c.white) CHECK(energy[k] == Approx(1).epsilon(5e-3));
      }
      if (c.material.coat_weight > 0 || (c.material.specular_anisotropy > 0)) continue;
      CHECK(b.albedo(wo).y == Approx(energy.y).epsilon(.05));
    }
  }
}

TEST_CASE("bsdf: reciprocal; across a boundary with the squares of the indices of refraction") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const Material material(c.material);
    const Bsdf b = make_bsdf(material, material.base_color(), c.opacity);
    int compared = 0;
    for (uint64_t i = 0; i < 400; ++i) {
      const Vec3f wo = uniform_sphere({float(random_unit(1, i)), float(random_unit(2, i))});
      const Vec3f wi = uniform_sphere({float(random_unit(3, i)), float(random_unit(4, i))});
      if (std::abs(wo.z) < .02f || std::abs(wi.z) < .02f) continue;
      const Vec3f there = b.evaluate(wo, wi), back = b.evaluate(wi, wo);
      double scale = 1;
      if (wo.z * wi.z < 0 && material.has_inside()) scale = wo.z > 0 ? double(material.ior()) : 1 / double(material.ior());
      for (int k = 0; k < 3; ++k) CHECK(double(there[k]) * scale * scale == Approx(double(back[k])).epsilon(3e-3).scale(1e-4));
      const Vec3f importance = b.evaluate(wo, wi, Transport::importance);
      CHECK(double(importance.y) == Approx(double(there.y) * scale * scale).epsilon(1e-4).scale(1e-4));
      compared += there.y > 0;
    }
    CHECK((compared > 50 || b.delta_only() || c.material.base_metalness == 1 || c.material.retro_weight == 1 ||
           c.material.transmission_weight == 1));
  }
}

TEST_CASE("bsdf: smooth glass bends light by Snell's law and mirrors beyond the critical angle; sheets let it straight through") {
  const Material glass(preset_material(MaterialPreset::glass)), sheet(preset_material(MaterialPreset::thin_glass));
  const Bsdf b = make_bsdf(glass);
  CHECK(b.delta_only());
  CHECK(glass.has_inside());
  const Vec3f wo = direction(.6, 1);
  const auto in = b.sample(wo, .999f, {.5f, .5f});
  REQUIRE(in);
  CHECK((in->transmitted && in->delta));
  CHECK(in->eta == Approx(1.5));
  CHECK(std::hypot(in->direction.x, in->direction.y) == Approx(.8 / 1.5).epsilon(1e-5));
  CHECK(in->weight.y == Approx(1 / 2.25).epsilon(1e-4));  // radiance is lower by eta^2 outside
  const auto out = b.sample(in->direction, .999f, {.5f, .5f});
  REQUIRE(out);
  CHECK(out->eta == Approx(1 / 1.5));
  for (int k = 0; k < 3; ++k) CHECK(out->direction[k] == Approx(double(wo[k])).epsilon(1e-5));
  const auto total = b.sample(direction(-.5, 1), .999f, {.5f, .5f});
  REQUIRE(total);
  CHECK_FALSE(total->transmitted);
  CHECK(total->weight.y == Approx(1));
  const Bsdf s = make_bsdf(sheet);
  CHECK_FALSE(sheet.has_inside());
  const auto through = s.sample(wo, .999f, {.5f, .5f});
  REQUIRE(through);
  CHECK(through->direction == -wo);
  CHECK(through->eta == 1);
}

TEST_CASE("bsdf: matte is base colour by pi, retroreflectors send light back, opacity passes straight on") {
  SurfaceMaterial described = preset_material(MaterialPreset::matte);
  const Material matte(described);
  const Bsdf b = make_bsdf(matte, {.2f, .5f, .9f});
  for (const Vec3f wo : directions()) {
    const Vec3f f = b.evaluate(wo, direction(wo.z > 0 ? .4 : -.4, 2));
    CHECK(f.x == Approx(.2 / M_PI).epsilon(1e-5));
    CHECK(f.z == Approx(.9 / M_PI).epsilon(1e-5));
    CHECK(b.evaluate(wo, direction(wo.z > 0 ? -.4 : .4, 2)) == Vec3f());
  }
  SurfaceMaterial retro;
  retro.retro_weight = 1, retro.specular_roughness = 0;
  const Material back(retro);
  CHECK(make_bsdf(back).sample(direction(.3, 1), .5f, {.1f, .7f})->direction == direction(.3, 1));
  const Bsdf half = make_bsdf(matte, {1, 1, 1}, .25f);
  const auto on = half.sample(direction(.3, 1), .1f, {.1f, .7f});
  CHECK(on->direction == -direction(.3, 1));
  CHECK((on->delta && on->transmitted && on->weight.x == Approx(1)));
  CHECK(half.evaluate(direction(.3, 1), direction(.5, 2)).x == Approx(.25 / M_PI).epsilon(1e-5));
}

TEST_CASE("bsdf: what enters below the surface and leaves it again keeps the energy of what is diffuse otherwise") {
  SurfaceMaterial described = preset_material(MaterialPreset::wax);
  described.subsurface_weight = .6, described.base_color = {1, 1, 1};
  const Material wax(described);
  const Bsdf whole = make_bsdf(wax, {1, 1, 1}), part = make_bsdf(wax, {1, 1, 1}, 1, true);
  double leaves = 0;
  for (int i = 0; i < 1000; ++i) {
    const float z = (float(i) + .5f) / 1000;
    leaves += double(part.leaving(direction(double(z), 1))) * 2 * double(z) / 1000;
  }
  CHECK(leaves == Approx(1).epsilon(1e-3));
  for (const Vec3f wo : directions())
    CHECK(double(part.albedo(wo).x + part.entering(wo).x) == Approx(double(whole.albedo(wo).x)).epsilon(1e-4));
}

TEST_CASE("bsdf: shares that pictures lower are those of a material that has them from the start") {
  for (const double rough : {0., .35})
    for (const bool thin : {false, true}) {
      CAPTURE(thin);
      SurfaceMaterial full;
      full.specular_roughness = rough, full.coat_roughness = .2, full.coat_color = {.9, .6, .5}, full.transmission_color = {.9, .5, .2};
      full.thin_walled = thin, full.subsurface_weight = full.base_metalness = full.coat_weight = full.transmission_weight = 1;
      SurfaceMaterial less = full;
      less.subsurface_weight = .3, less.base_metalness = .25, less.coat_weight = .5, less.transmission_weight = .75;
      const Material varies(full, 1, 1, true), known(less);
      MaterialShares shares = varies.shares;
      shares.subsurface *= .3f, shares.metalness *= .25f, shares.coat *= .5f, shares.clear *= .75f;
      const Bsdf a = make_bsdf(varies, shares, {.7f, .4f, .9f}), b = make_bsdf(known, {.7f, .4f, .9f});
      const auto same = [](Vec3f x, Vec3f y) {
        for (int k = 0; k < 3; ++k) CHECK(double(x[k]) == Approx(double(y[k])).epsilon(1e-5));
      };
      for (const Vec3f wo : directions()) {
        same(a.albedo(wo), b.albedo(wo)), same(a.straight_on(wo), b.straight_on(wo));
        for (const Vec3f wi : directions()) {
          same(a.evaluate(wo, wi), b.evaluate(wo, wi));
          CHECK(double(a.pdf(wo, wi)) == Approx(double(b.pdf(wo, wi))).epsilon(1e-5));
        }
      }
    }
}
