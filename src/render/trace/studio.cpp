// SPDX-License-Identifier: Apache-2.0
#include "render/trace/studio.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "base/error.h"
#include "base/overloaded.h"
#include "render/shade/lamp.h"
#include "render/trace/light/atmosphere.h"
#include "render/trace/light/luminance.h"
#include "render/trace/light/sky.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

constexpr float beside_lights = 0.15f;
constexpr double set_brightness = 0.2;  // of what lies level when the sun has set
constexpr int sky_height = 256;         // pixels of its picture

float rise_of(double degrees) {
  // 1 - cos of half of it, which is 2 sin^2 of a quarter.
  const double s = std::sin(degrees / 4 * std::numbers::pi / 180);
  return float(2 * s * s);
}
Environment even(float v) { return Environment(Vec3f{v, v, v}); }

/// Metals and glass show what is around them: bright above the viewer's head, so that metals have a shape, and behind the data, so that
/// glass is clear and what is seen at a slant has a rim; dark below. A white surface that faces the viewer is 0.31 of white by it.
Environment usual_sky(const Projection& projection) {
  constexpr float dark = 0.1f, above = 0.45f, behind = 0.4f;
  constexpr double tilt = 0.45;  // radians, towards the viewer
  const auto grey = [](float v) { return Vec3f(v, v, v); };
  const Vec3 top = projection.up * std::cos(tilt) - projection.forward * std::sin(tilt);
  return {grey(dark), {grey(above), Vec3f(normalize(top)), -0.3f}, {grey(behind), Vec3f(projection.forward), 0.2f}};
}
Vec3f direction_of(const PlacedLight& p, const Lighting& l, const Projection& projection) {
  return Vec3f(world_way(p, l, projection.right, projection.up, projection.forward));
}

/// Irradiance of what faces the sun, with the brightness of a light.
Vec3 sun_irradiance(const PlacedLight& p) {
  const Atmosphere air = Atmosphere::with_haze(p.haze);
  const Vec3 left = transmittance(air, air.ground, std::sin(p.elevation * std::numbers::pi / 180), 400);
  const double bright = luminance(Vec3f(left));
  if (!(bright > 0)) fail_usage("the sun has set", "light sun", "raise it, or take its sky alone: --environment 'sky elevation=-2'");
  return left * (std::numbers::pi * p.brightness / bright);
}
DistantLight sun_light(Vec3f direction, Vec3 irradiance) { return {direction, Vec3f(irradiance), rise_of(sun_width)}; }

AnyLight traced(const PlacedLight& p, const Lighting& l, const Projection& projection, const Placement& placement) {
  using Shape = PlacedLight::Shape;
  const Vec3f direction = direction_of(p, l, projection);
  if (p.shape == Shape::sun) return sun_light(direction, sun_irradiance(p));
  if (p.shape == Shape::directional) return DistantLight{direction, p.color * float(std::numbers::pi * p.brightness), rise_of(p.angle)};
  const double distance = length(p.way);
  const Vec3 at = distance > 0 ? p.about + Vec3(direction) * distance : p.about;
  const Vec3f middle = placement.traced(at), radiance = p.color * float(p.radiance);
  if (p.shape == Shape::point) return PointLight{middle, p.color * float(p.radiance * placement.scale * placement.scale)};
  if (p.shape == Shape::spot)
    return SpotLight{middle, Vec3f(normalize(p.target - at)), p.color * float(p.radiance * placement.scale * placement.scale),
                     rise_of(2 * p.inner), rise_of(2 * p.outer)};
  if (p.shape == Shape::sphere) return SphereLight{middle, float(p.radius * placement.scale), radiance};
  const Vec3 normal = normalize(p.target - at);
  if (p.shape == Shape::disc) return DiscLight{middle, Vec3f(normal), float(p.radius * placement.scale), radiance};
  // Its sides lie level and upright, as a window's.
  Vec3 across = cross(l.up, normal);
  if (!(length(across) > 1e-6)) across = cross(l.front, normal);
  const Vec3 u = normalize(across), v = cross(normal, u);
  const Vec3f a(u * (p.width * placement.scale)), b(v * (p.height * placement.scale));
  return RectangleLight{middle - a * 0.5f - b * 0.5f, a, b, radiance};
}

void add_sky(const SkyEnvironmentParams& stated, const Scene& scene, const Projection& projection, Studio& studio) {
  const Lighting& l = scene.lighting;
  const PlacedLight sun = place_sun(l, stated);
  const Vec3f direction = direction_of(sun, l, projection);
  const Sky sky = make_sky(SkyModel(Atmosphere::with_haze(sun.haze)), sun.elevation, sky_height);
  const bool risen = luminance(Vec3f(sky.sun)) > 0;
  const SunLightParams* light = nullptr;
  for (const LightParams& any : l.lights)
    if (const auto* s = std::get_if<SunLightParams>(&any); s && !light) light = s;
  // In twilight the sky itself would be white if what lies level was.
  const double all = risen ? luminance(Vec3f(sky.sun)) + luminance(Vec3f(sky.facing)) : luminance(Vec3f(sky.level)) / set_brightness;
  double factor = std::numbers::pi * stated.brightness / all;
  // With the sun as a light the sky is as bright as that sun makes it.
  if (light && !stated.sun && risen) factor = std::numbers::pi * light->brightness * stated.brightness / luminance(Vec3f(sky.sun));
  // Straight above any direction will do as the front.
  const Vec3 front = std::abs(dot(Vec3(direction), normalize(l.up))) < 0.9999 ? Vec3(direction) : l.front;
  studio.environment = Environment(sky.pixels, size_t(sky.width), l.up, front, float(factor));
  if (risen && stated.sun.value_or(!light)) {
    const DistantLight disc = sun_light(direction, sky.sun * factor);
    studio.lights.emplace_back(disc), studio.backdrop.sun = disc;
  }
  studio.backdrop.seen = stated.background;
}

void add_picture(const PictureEnvironmentParams& stated, const Lighting& l, Studio& studio) {
  if (!l.picture) fail_usage(stated.file + " was not read", "environment");
  const Vec3 up = normalize(l.up), north = -normalize(l.front), east = cross(north, up);
  const double a = stated.rotate * std::numbers::pi / 180;
  studio.environment =
      Environment(l.picture->pixels, size_t(l.picture->width), up, north * std::cos(a) + east * std::sin(a), float(stated.strength));
  if (!(luminance(studio.environment.mean()) > 0)) fail_usage("is all black", stated.file, "an environment gives light");
  studio.backdrop.seen = stated.background;
}

void add_environment(const Scene& scene, const Projection& projection, Studio& studio) {
  std::visit(Overloaded{[](const NoEnvironmentParams&) {},
                        [&](const EvenEnvironmentParams& e) {
                          studio.environment = Environment(light_color(e.color) * float(e.brightness));
                          studio.backdrop.seen = e.background;
                        },
                        [&](const SkyEnvironmentParams& e) { add_sky(e, scene, projection, studio); },
                        [&](const PictureEnvironmentParams& e) { add_picture(e, scene.lighting, studio); }},
             *scene.lighting.environment);
  studio.backdrop.environment = studio.environment;
}

}  // namespace

Vec3f Backdrop::radiance(Vec3f direction) const {
  Vec3f sum = environment.radiance(direction);
  if (sun && 1 - dot(direction, sun->direction) < sun->rise) sum += sun->irradiance / (pi * sun->rise * (2 - sun->rise));
  return {std::min(sum.x, 1.f), std::min(sum.y, 1.f), std::min(sum.z, 1.f)};
}

Studio studio_of(const Scene& scene, const Projection& projection, const Placement& placement) {
  const Lighting& stated = scene.lighting;
  Studio studio;
  for (const PlacedLight& p : place_lights(stated, scene_bounds(scene))) studio.lights.push_back(traced(p, stated, projection, placement));
  if (stated.environment) add_environment(scene, projection, studio);
  else studio.environment = stated.lights.empty() ? usual_sky(projection) : even(beside_lights);
  if (stated.stated() && scene.lights.empty()) return studio;
  for (const Lamp& lamp : lamps_of(lights_of(scene), projection)) {
    if (!(lamp.intensity > 0)) continue;
    const float e = lamp.irradiance;
    studio.lights.emplace_back(DistantLight{Vec3f(lamp.direction), {e, e, e}, rise_of(12)});
  }
  return studio;
}

}  // namespace sg::trace
