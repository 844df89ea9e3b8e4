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

/// A square about the origin with fields that rise along x ("rough", 0 to 1), along y ("metal", 0 to 1), and along x ("glow", -2 to 6).
DatasetPtr square() {
  FieldSet f;
  const auto add = [&](const char* name, std::vector<float> values) {
    f.add({name, Association::point, Array::from_vector(std::move(values)), "", Role::scalars});
  };
  add("rough", {0, 1, 1, 0}), add("metal", {0, 0, 1, 1}), add("glow", {-2, 6, 6, -2});
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
  p.material_fields.specular_roughness_by = {"rough"}, p.material_fields.base_metalness_by = {"metal"};
  p.material_fields.emission_by = {"glow"};
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
  p.material_fields.transmission_weight_by = {"rough"}, p.material_fields.coat_weight_by = {"metal"};
  p.material_fields.subsurface_weight_by = {"rough"}, p.material.subsurface_weight = 0.5;
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
  p.material_fields.specular_roughness_by = {"rough"}, p.material_fields.emission_by = {"glow"};
  p.material.specular_roughness = 0.5, p.material.emission = {0.5, 1, 0};
  const LitWorld w(shown(p, context));
  const Vertex v = met(w, 0.45f, 0);
  check_alpha(*v.material, 0.75 * 0.5);
  CHECK(v.bsdf.material_shares().metalness == 0);
  CHECK(v.emission.x == Approx(2));
  CHECK(v.emission.y == Approx(4));
  CHECK(v.emission.z == 0);
  p.material_fields = {};
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
  p.material_fields.specular_roughness_by = {"glow"};
  const LitWorld w(shown(p, context));
  CHECK(sg::test::contains(said, "from -2 to 6"));
  check_alpha(*met(w, 0.8f, 0).material, 1);
  check_alpha(*met(w, -0.8f, 0).material, 0);
  p.material_fields = {};
  p.material_fields.emission_by = {"nothing"};
  CHECK(sg::test::contains(sg::test::error_of([&] { shown(p, context); }), "emission_by"));
}
