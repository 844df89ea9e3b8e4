// SPDX-License-Identifier: Apache-2.0
// Stated lights as they are traced: where, how bright, and what is seen behind the data.
#include "render/trace/studio.h"

#include <cmath>
#include <string>
#include <variant>

#include "render/raster/raster_support.h"
#include "render/trace/light/luminance.h"
#include "render/trace/sampling/sampler.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

Scene scene_with(const std::string& lights, const std::string& environment = "") {
  Scene scene;
  scene.items.emplace_back(test::item(test::sphere(20, 1)));
  scene.lighting.lights = parse_lights(lights), scene.lighting.environment = parse_environment(environment);
  return scene;
}
Projection projection_of(const Scene& scene, Vec3 direction) {
  return make_projection(fit_camera(scene_bounds(scene), direction, {0, 0, 1}, 1), 32, 32);
}
Studio studio(const Scene& scene, Vec3 direction = {0, -1, 0}) {
  return studio_of(scene, projection_of(scene, direction), Placement::of(scene_bounds(scene)));
}

/// Irradiance / pi of what faces the mean direction of the light at the middle of the scene, in Monte Carlo, with its standard error.
struct Found {
  double value, error;
  Vec3f towards;
};
Found brightness(const std::string& light, Vec3 direction = {0, -1, 0}) {
  const Studio s = studio(scene_with(light, "none"), direction);
  const Lights lights(s.lights, s.environment, 1);
  constexpr int n = 20'000;
  Sampler sampler(SamplerKind::independent, 3, n);
  Vec3f towards;
  for (int i = 0; i < 500; ++i) {
    sampler.start(1, 0, uint32_t(i));
    const float choice = sampler.next();
    if (const auto l = lights.sample({}, choice, sampler.next2())) towards += l->direction;
  }
  towards = normalize(towards);
  double sum = 0, square = 0;
  for (int i = 0; i < n; ++i) {
    sampler.start(0, 0, uint32_t(i));
    const float choice = sampler.next();
    const auto l = lights.sample({}, choice, sampler.next2());
    const double e =
        l ? double(luminance(l->radiance)) * double(std::max(0.f, dot(l->direction, towards))) / double(l->pdf) / 3.14159265 : 0;
    sum += e / n, square += e * e / n;
  }
  return {sum, std::sqrt(std::max(0.0, square - sum * sum) / n), towards};
}

}  // namespace

TEST_CASE("studio: a light of brightness 1 makes white what faces it in the middle of the data, whatever its kind and size") {
  for (const char* light :
       {"point", "spot", "spot position=0,-3,1 angle=60 inner=10", "sphere", "sphere size=2 distance=1.5", "disc size=1.5", "rectangle",
        "rectangle size=3,0.2 distance=0.5", "directional", "directional angle=60", "sphere position=0,-40,9 radius=3", "sun elevation=15",
        "rectangle from=above", "disc position=0,0,5 radius=1"}) {
    const Found f = brightness(light);
    CAPTURE(light);
    CHECK(std::abs(f.value - 1) <= 4 * f.error + 5e-3);
  }
  CHECK(brightness("sphere brightness=0.25").value == Approx(0.25).epsilon(0.02));
  CHECK(brightness("point color=#808080").value == Approx(0.21586).epsilon(0.01));
}

TEST_CASE("studio: lights turn with the viewer, those of the data and the sun's height do not") {
  for (const Vec3 direction : {Vec3{0, -1, 0}, Vec3{1, 0.3, 0.5}}) {
    const Scene scene = scene_with("");
    const Projection p = projection_of(scene, direction);
    const Vec3f left = brightness("sphere from=left-above", direction).towards;
    CHECK(dot(Vec3(left), p.right) < -0.3);
    CHECK(dot(Vec3(left), p.up) > 0.3);
    CHECK(dot(Vec3(left), p.forward) < -0.3);
    CHECK(brightness("sphere azimuth=0 elevation=90 frame=data", direction).towards.z > 0.999f);
    CHECK(brightness("sun elevation=20", direction).towards.z == Approx(std::sin(20 * 3.14159265 / 180)).epsilon(0.01));
    CHECK(brightness("directional azimuth=90 frame=data", direction).towards.x > 0.999f);
  }
}

TEST_CASE("studio: what is stated takes the place of the usual light") {
  const Studio usual = studio(scene_with("")), lit = studio(scene_with("point")), even = studio(scene_with("", "even brightness=0.5")),
               dark = studio(scene_with("point", "none"));
  CHECK(usual.lights.size() == 2);
  CHECK_FALSE(usual.backdrop.seen);
  CHECK(lit.lights.size() == 1);
  CHECK(lit.environment.mean().x < usual.environment.mean().x);
  CHECK(even.lights.empty());
  CHECK(even.environment.mean().x == Approx(0.5));
  CHECK(dark.environment.dark());
  CHECK(studio(scene_with("", "even background=true")).backdrop.seen);
}

TEST_CASE("studio: a white surface that faces the sun is white by sun and sky together; with the sun as a light the sky follows it") {
  for (const char* sky : {"sky elevation=60", "sky elevation=5"}) {
    const Studio s = studio(scene_with("", sky));
    REQUIRE(s.lights.size() == 1);
    const auto& sun = std::get<DistantLight>(s.lights[0]);
    double e = double(luminance(sun.irradiance));
    constexpr int n = 40'000;
    Sampler sampler(SamplerKind::sobol, 1, n);
    for (int i = 0; i < n; ++i) {
      sampler.start(0, 0, uint32_t(i));
      const auto v = s.environment.sample(sampler.next2());
      e += double(luminance(v.radiance)) * double(std::max(0.f, dot(v.direction, sun.direction))) / double(v.pdf) / n;
    }
    CAPTURE(sky);
    CHECK(e / 3.14159265 == Approx(1).epsilon(0.01));
    CHECK(s.backdrop.seen);
    // Straight at the sun it is white, opposite of it the sky's.
    CHECK(s.backdrop.radiance(sun.direction) == Vec3f{1, 1, 1});
    const Vec3f up{0, 0, 1};
    CHECK(s.backdrop.radiance(up) == s.environment.radiance(up));
  }
  const Studio twilight = studio(scene_with("", "sky elevation=-4 background=false"));
  CHECK(twilight.lights.empty());
  CHECK_FALSE(twilight.backdrop.seen);
  CHECK(twilight.environment.mean().x > 0.05f);
  const Studio both = studio(scene_with("sun elevation=30 azimuth=200 brightness=0.5", "sky"));
  REQUIRE(both.lights.size() == 1);
  CHECK(luminance(std::get<DistantLight>(both.lights[0]).irradiance) == Approx(3.14159265 / 2).epsilon(1e-3));
  // The aureole is about that sun.
  const Vec3f towards = std::get<DistantLight>(both.lights[0]).direction;
  CHECK(luminance(both.environment.radiance(towards)) > 2 * luminance(both.environment.radiance({-towards.x, -towards.y, towards.z})));
}

TEST_CASE("studio: the middle of a picture lies behind the data, and turns clockwise") {
  Scene scene = scene_with("", "hall.hdr strength=2");
  auto hall = std::make_shared<LinearPicture>();
  hall->width = 8, hall->height = 4, hall->pixels.assign(32, Vec3f{0.1f, 0.1f, 0.1f});
  for (size_t y = 0; y < 4; ++y) hall->pixels[y * 8 + 3] = hall->pixels[y * 8 + 4] = {0.4f, 0, 0};
  scene.lighting.picture = hall;
  const Vec3f north{0, 1, 0}, east{1, 0, 0};
  CHECK(studio(scene).environment.radiance(north).x == Approx(0.8));
  CHECK(studio(scene).environment.radiance(east).x == Approx(0.2));
  scene.lighting.environment = parse_environment("hall.hdr rotate=90");
  CHECK(studio(scene).environment.radiance(east).x == Approx(0.4));
  CHECK(studio(scene).environment.radiance(east).y == Approx(0));
  hall->pixels.assign(32, Vec3f{});
  CHECK(test::contains(test::error_of([&] { studio(scene); }), "black"));
}

TEST_CASE("studio: where nothing is stated, light comes from above the viewer's head, and a surface that faces the viewer has its share") {
  const Scene scene = scene_with("");
  const Projection p = projection_of(scene, {0, -1, 0.4});
  const Environment sky = studio_of(scene, p, Placement::of(scene_bounds(scene))).environment;
  const Vec3f up(p.up), back(-p.forward), right(p.right);
  CHECK(sky.radiance(normalize(up * 2 + back)).x > 5 * sky.radiance(-up).x);
  CHECK(sky.radiance(right).x == Approx(sky.radiance(-right).x));
  // The mean over all directions, and irradiance / pi of what faces the viewer, by a grid of 10^6 directions.
  double mean = 0, facing = 0;
  constexpr int n = 1000;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      const double z = (i + 0.5) / n * 2 - 1, a = (k + 0.5) / n * 2 * 3.14159265358979, r = std::sqrt(1 - z * z);
      const double l = double(sky.radiance(back * float(z) + up * float(r * std::cos(a)) + right * float(r * std::sin(a))).x);
      mean += l / n / n, facing += std::max(0.0, z) * 4 * l / n / n;
    }
  CHECK(double(sky.mean().x) == Approx(mean).epsilon(1e-4));
  CHECK(facing == Approx(0.31).epsilon(0.02));
}
