// SPDX-License-Identifier: Apache-2.0
// Clear bodies that overlap: what is where, and what light loses on its way, in closed form.
#include <cmath>
#include <vector>

#include "light_scenes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

SurfaceMaterial clear(double ior, int priority, Vec3 color = {1, 1, 1}, double depth = 0) {
  SurfaceMaterial m;
  m.transmission_weight = 1, m.specular_roughness = 0, m.specular_ior = ior, m.dielectric_priority = priority;
  m.transmission_color = color, m.transmission_depth = depth;
  return m;
}

/// A closed box, 0.5 to each side of the z axis.
SurfaceItem slab(float bottom, float top, const SurfaceMaterial& made_of) {
  std::vector<float> xyz;
  for (int i = 0; i < 8; ++i) xyz.insert(xyz.end(), {i & 1 ? 0.5f : -0.5f, i & 2 ? 0.45f : -0.5f, i & 4 ? top : bottom});
  SurfaceItem item = sg::test::item(sg::test::surface(
      std::move(xyz), {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5}));
  item.made_of = made_of, item.flat = true;
  return item;
}

/// Over a black floor that gives off light of radiance 1.
LitWorld over_light(std::vector<SurfaceItem> bodies) {
  LightScene s;
  add_floor(s, 0);
  std::get<SurfaceItem>(s.scene.items[0]).made_of->emission = {1, 1, 1};
  for (SurfaceItem& b : bodies) s.scene.items.emplace_back(std::move(b));
  return LitWorld(s);
}

const Ray down{{0.1f, 0.07f, 0.8f}, {0, 0, -1}}, up{{0.1f, 0.07f, -0.8f}, {0, 0, 1}};

void check_seen(const LitWorld& w, double exact) {
  sg::test::Moments seen;
  Sampler sampler(SamplerKind::independent, 1, 20'000);
  const auto integrator = path_integrator(30);
  for (uint32_t i = 0; i < 20'000; ++i) {
    sampler.start(0, 0, i);
    seen.add(double(integrator->along(w.world, down, sampler).radiance.x));
  }
  CAPTURE(exact);
  CAPTURE(seen.mean);
  CHECK(std::abs(seen.mean - exact) <= 4 * seen.standard_error() + 1e-6);
}

/// What passes faces between matter with these indices of refraction, straight on, with all that goes to and fro between them.
double passed(const std::vector<double>& indices) {
  double sum = 1;
  for (size_t i = 1; i < indices.size(); ++i) {
    const double r = std::pow((indices[i] - indices[i - 1]) / (indices[i] + indices[i - 1]), 2);
    sum += r / (1 - r);
  }
  return 1 / sum;
}

}  // namespace

TEST_CASE("bodies in bodies: faces of clear bodies reflect by what is on both sides (4 standard errors)") {
  // Glass that stands in water, whose surface dips into it; and the other way round.
  check_seen(over_light({slab(-0.1f, 0.5f, clear(1.333, 1)), slab(-0.6f, 0.1f, clear(1.5, 2))}), passed({1, 1.333, 1.5, 1}));
  check_seen(over_light({slab(-0.6f, 0.1f, clear(1.8, 7)), slab(-0.1f, 0.5f, clear(1.2, 3))}), passed({1, 1.2, 1.8, 1}));
  // A ball of air would be one in water: less dense than what is around it.
  check_seen(over_light({slab(-0.6f, 0.5f, clear(1.5, 1)), slab(-0.3f, 0.2f, clear(1.0, 2))}), passed({1, 1.5, 1, 1.5, 1}));
  // The same matter within itself is not to be seen, and what has no priority is as if in air.
  check_seen(over_light({slab(-0.6f, 0.5f, clear(1.5, 4)), slab(-0.3f, 0.2f, clear(1.5, 4))}), passed({1, 1.5, 1}));
  check_seen(over_light({slab(-0.6f, 0.5f, clear(1.5, 0)), slab(-0.3f, 0.2f, clear(1.5, 0))}), passed({1, 1.5, 1, 1.5, 1}));
  // Three, the middle one on top.
  check_seen(over_light({slab(-0.6f, 0.f, clear(1.3, 1)), slab(-0.3f, 0.3f, clear(1.7, 3)), slab(0.1f, 0.5f, clear(1.5, 2))}),
             passed({1, 1.5, 1.7, 1.3, 1}));
}

TEST_CASE("bodies in bodies: light fades by the one that is there, on paths and towards lamps") {
  const Vec3 half{0.5, 0.5, 0.5}, tenth{0.1, 0.1, 0.1};
  for (const bool lower_wins : {false, true}) {
    CAPTURE(lower_wins);
    // 0.6 of the lower body, 0.6 of the upper one, 0.2 of them both.
    const LitWorld w =
        over_light({slab(-0.6f, 0.f, clear(1, lower_wins ? 2 : 1, half, 1)), slab(-0.2f, 0.4f, clear(1, lower_wins ? 1 : 2, tenth, 1))});
    const double lower = lower_wins ? 0.6 : 0.4, upper = lower_wins ? 0.4 : 0.6, exact = std::pow(0.5, lower) * std::pow(0.1, upper);
    check_seen(w, exact);
    for (Ray ray : {down, up}) {
      ray.t_max = 1.5f;
      CHECK(w.world.passes(ray).x == Approx(exact).epsilon(1e-5));
    }
    // From the middle of both.
    Ray ray{{0.1f, 0.07f, -0.1f}, {0, 0, 1}, 0.7f};
    const Insides both = w.world.insides_at(ray.origin, ray.direction);
    CHECK_FALSE(both.none());
    CHECK(w.world.passes(ray, both).x == Approx(lower_wins ? std::pow(0.5, 0.1) * std::pow(0.1, 0.4) : std::pow(0.1, 0.5)).epsilon(1e-5));
  }
}

TEST_CASE("bodies in bodies: closed surfaces have their inside within, whichever way their triangles wind") {
  SurfaceItem turned = slab(-0.6f, 0.5f, clear(1.5, 0));
  SurfaceMesh mesh = std::get<SurfaceMesh>(turned.data->mesh());
  const Array given = mesh.polygons.connectivity;
  std::vector<int32_t> indices;
  for (size_t i = given.count(); i-- > 0;) indices.push_back(int32_t(given.get(i)));
  mesh.polygons.connectivity = Array::from_vector(std::move(indices));
  turned.data = make_dataset(Mesh(std::move(mesh)));
  const LitWorld w = over_light({turned});
  Hit hit;
  REQUIRE(w.world.geometry().nearest(down, hit));
  CHECK(w.world.at(down, hit).point.face_normal == Vec3f(0, 0, 1));
  check_seen(w, passed({1, 1.5, 1}));
}

TEST_CASE("bodies in bodies: a camera in a clear body sees through what is there of it") {
  LitWorld w = over_light({slab(-0.6f, 0.5f, clear(1, 0, {0.5, 0.5, 0.5}, 1)), slab(-0.4f, -0.2f, clear(1, 0, {0.1, 0.1, 0.1}, 1))});
  const Ray from_inside{{0.1f, 0.07f, 0.3f}, {0, 0, -1}};
  w.world.look_from(from_inside);
  Sampler sampler(SamplerKind::independent, 1, 1);
  sampler.start(0, 0, 0);
  const Vec3f seen = path_integrator(4)->along(w.world, from_inside, sampler).radiance;
  CHECK(seen.x == Approx(std::pow(0.5, 0.7) * std::pow(0.1, 0.2)).epsilon(1e-4));
  // Beside all bodies there is none.
  CHECK(w.world.insides_at({0.8f, 0.8f, 0.3f}, {0, 0, -1}).none());
}
