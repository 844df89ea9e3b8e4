// SPDX-License-Identifier: Apache-2.0
// Parameters of materials by words and by fields: what a ray that meets the surface finds there.
#include <cmath>

#include "light_scenes.h"
#include "scene/show/surface.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

/// A square about the origin with fields that rise along x ("rough", 0 to 1), along y ("metal", 0 to 1), and along x ("glow", -2 to 6, and
/// "index", 1.2 to 2), and one of directions, ("along", 1, 2, 3).
DatasetPtr square() {
  FieldSet f;
  const auto add = [&](const char* name, std::vector<float> values) {
    f.add({name, Association::point, Array::from_vector(std::move(values)), "", Role::scalars});
  };
  add("rough", {0, 1, 1, 0}), add("metal", {0, 0, 1, 1}), add("glow", {-2, 6, 6, -2}), add("index", {1.2f, 2, 2, 1.2f});
  f.add({"along", Association::point, Array::from_vector(std::vector<float>{1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3}, 3), "", Role::vectors});
  return sg::test::quad(0.9f, 0, std::move(f));
}

LightScene shown(const SurfaceShow& p, Context& context) {
  LightScene s;
  add(s.scene, square(), p, context);
  s.scene.items.emplace_back(sheet({-0.9f, 0.9f, -0.8f}, {0.1f, 0, 0}, {0, 0, 0.1f}, diffuse()));
  s.scene.items.emplace_back(sheet({-0.9f, 0.9f, 0.7f}, {0.1f, 0, 0}, {0, 0, 0.1f}, diffuse()));
  return s;
}

Vertex met(const LitWorld& w, float x, float y) {
  const Ray ray{{x, y, 0.8f}, {0, 0, -1}};
  Hit hit;
  REQUIRE(w.world.geometry().nearest(ray, hit));
  return w.world.at(ray, hit);
}

void check_alpha(const trace::Material& m, double roughness) {
  const Ggx want = Ggx::of_roughness(float(roughness));
  for (const Vec3f n : {normalize(Vec3f{0.1f, 0, 1}), normalize(Vec3f{0.5f, 0.2f, 1})}) CHECK(m.ggx.normals(n) == Approx(want.normals(n)));
}

}  // namespace

TEST_CASE("materials by fields: roughness, metal and light are what the fields say, to the steps in which they are kept") {
  Context context;
  SurfaceShow p;
  p.varying.by[size_t(MaterialFactor::roughness)] = {"rough"}, p.varying.by[size_t(MaterialFactor::metalness)] = {"metal"};
  p.varying.emission_by = {"glow"};
  const LitWorld w(shown(p, context));
  for (const double rough : {0.125, 0.5, 0.875})
    for (const double metal : {0.25, 0.5, 0.875}) {
      const Vertex v = met(w, float(0.9 * (2 * rough - 1)), float(0.9 * (2 * metal - 1)));
      CHECK(double(v.bsdf.material_shares().metalness) == Approx(metal));
      check_alpha(*v.material, rough);
      CHECK(double(v.emission.y) == Approx(std::max(0.0, 8 * rough - 2)).epsilon(1e-4));
    }
  // Other surfaces ask for this light.
  CHECK(w.world.lights().any());
}

TEST_CASE("materials by fields: shares of glass, of a coat and of what light wanders in are what the fields say") {
  Context context;
  SurfaceShow p;
  p.varying.by[size_t(MaterialFactor::transmission)] = {"rough"}, p.varying.by[size_t(MaterialFactor::coat)] = {"metal"};
  p.varying.by[size_t(MaterialFactor::subsurface)] = {"rough"}, p.material.subsurface_weight = 0.5;
  const LitWorld w(shown(p, context));
  for (const double x : {0.05, 0.5, 0.9})
    for (const double y : {0.2, 0.7}) {
      const MaterialShares shares = met(w, float(0.9 * (2 * x - 1)), float(0.9 * (2 * y - 1))).bsdf.material_shares();
      CHECK(double(shares.clear) == Approx(x));
      CHECK(double(shares.coat) == Approx(y));
      CHECK(double(shares.subsurface) == Approx(x / 2));
      CHECK(shares.metalness == 0);
    }
}

TEST_CASE("materials by fields: they multiply what is stated") {
  Context context;
  SurfaceShow p;
  p.varying.by[size_t(MaterialFactor::roughness)] = {"rough"}, p.varying.emission_by = {"glow"};
  p.material.specular_roughness = 0.5, p.material.emission = {0.5, 1, 0};
  const LitWorld w(shown(p, context));
  const Vertex v = met(w, 0.45f, 0);
  check_alpha(*v.material, 0.75 * 0.5);
  CHECK(v.bsdf.material_shares().metalness == 0);
  CHECK(v.emission.x == Approx(2));
  CHECK(v.emission.y == Approx(4));
  CHECK(v.emission.z == 0);
  p.varying = {};
  p.material.material = MaterialPreset::glass, p.material.specular_roughness = 0.3, p.material.dielectric_priority = 4;
  const LitWorld glass(shown(p, context));
  const Vertex g = met(glass, 0.45f, 0);
  check_alpha(*g.material, 0.3);
  CHECK(g.material->ior() == Approx(1.5));
  CHECK(g.material->priority() == 4);
}

TEST_CASE("materials by fields: values beyond 0 to 1 are told, fields that are not there refused") {
  std::string said;
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) { said += text; };
  SurfaceShow p;
  p.varying.by[size_t(MaterialFactor::roughness)] = {"glow"};
  const LitWorld w(shown(p, context));
  CHECK(sg::test::contains(said, "from -2 to 6"));
  check_alpha(*met(w, 0.8f, 0).material, 1);
  check_alpha(*met(w, -0.8f, 0).material, 0);
  p.varying = {};
  p.varying.emission_by = {"nothing"};
  CHECK(sg::test::contains(sg::test::error_of([&] { shown(p, context); }), "emission_by"));
}

TEST_CASE("materials by fields: indices of refraction are the field's own values, and all other numbers multiplied") {
  using enum MaterialFactor;
  Context context;
  SurfaceShow p;
  const auto by = [&](MaterialFactor f) -> FieldName& { return p.varying.by[size_t(f)]; };
  by(ior) = {"index"};
  p.material.specular_weight = 1;
  const LitWorld refracting(shown(p, context));
  for (const double share : {0.25, 0.5, 1.0})  // 1.2 to 2
    CHECK(double(met(refracting, float(0.9 * (2 * share - 1) * 0.999999), 0).material->ior()) ==
          Approx(1.2 + 0.8 * share).epsilon(0.03));  // steps of 1/32

  p = {};
  by(retro) = {"rough"}, by(transmission_color) = {"rough"}, by(coat_color) = {"metal"}, by(subsurface_radius) = {"rough"};
  by(subsurface_anisotropy) = {"metal"};
  p.material.transmission_weight = 1, p.material.transmission_color = {1, 0.5, 1}, p.material.coat_weight = 1;
  p.material.subsurface_weight = 1, p.material.subsurface_radius = {1, 2, 3}, p.material.subsurface_anisotropy = -0.5;
  const LitWorld w(shown(p, context));
  const Vertex v = met(w, 0.45f, -0.45f);  // rough 0.75, metal 0.25
  const MaterialShares& shares = v.bsdf.material_shares();
  CHECK(shares.retro == Approx(0.75));
  CHECK(shares.clear_filter.x == Approx(0.75));
  CHECK(shares.clear_filter.y == Approx(0.375));
  CHECK(shares.coat_filter.x == Approx(0.5));  // of one passage of two
  const float length = float(w.world.geometry().placement().scale);
  CHECK(v.below_radius.z == Approx(0.75f * 3 * length));
  CHECK(v.below_anisotropy == Approx(-0.125));
}

TEST_CASE("materials by fields: highlights are stretched along a field of directions") {
  Context context;
  SurfaceShow p;
  p.varying.specular_direction = {"along"};
  p.material.specular_roughness = 0.5;
  const LitWorld w(shown(p, context));
  const Vertex v = met(w, 0.3f, 0.2f);
  // In the plane z = 0 along (1, 2), whatever the field says across it.
  const Vec3f along = normalize(Vec3f{1, 2, 0});
  CHECK(v.frame.to_world({1, 0, 0}).x == Approx(along.x));
  CHECK(v.frame.to_world({1, 0, 0}).y == Approx(along.y));
  // Light from in front, in the direction of the highlight's length and across it, each 40 degrees off the mirror.
  const auto seen = [&](Vec3f side) {
    return v.bsdf.evaluate(v.frame.to_local({0, 0, 1}), v.frame.to_local(normalize(Vec3f{0, 0, 1} + side * 0.84f))).x;
  };
  CHECK(seen(along) > 2 * seen({-along.y, along.x, 0}));
  p.varying.specular_anisotropy = 0;
  const LitWorld round(shown(p, context));
  const Vertex even = met(round, 0.3f, 0.2f);
  CHECK(even.material->ggx.isotropic());
  p = {};
  p.varying.specular_anisotropy = 0.5;
  CHECK(sg::test::contains(sg::test::error_of([&] { shown(p, context); }), "specular_direction"));
  p.varying.specular_direction = {"rough"};
  CHECK(sg::test::contains(sg::test::error_of([&] { shown(p, context); }), "component"));
}

TEST_CASE("materials by fields: what shows nothing is told, and a body has one colour inside") {
  using enum MaterialFactor;
  std::string said;
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) { said += text; };
  SurfaceShow p;
  p.varying.by[size_t(coat_color)] = {"rough"};
  shown(p, context);
  CHECK(sg::test::contains(said, "coat_weight=1"));
  said.clear();
  p.varying.by[size_t(coat)] = {"metal"};
  shown(p, context);
  CHECK(said.empty());
  p = {};
  p.varying.by[size_t(transmission_color)] = {"rough"};
  p.material.transmission_weight = 1, p.material.transmission_depth = 2;
  CHECK(sg::test::contains(sg::test::error_of([&] { shown(p, context); }), "transmission_depth=0"));
}
