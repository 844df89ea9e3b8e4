// SPDX-License-Identifier: Apache-2.0
#include "scene/light/lighting.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/overloaded.h"

namespace sg {

namespace {

constexpr double pi = std::numbers::pi;
double radians(double degrees) { return degrees * pi / 180; }

// In eye space: x right, y up, z towards the viewer.
Vec3 way_of(LightSide side) {
  switch (side) {
    case LightSide::front: return {0, 0.15, 1};
    case LightSide::left: return {-1, 0.15, 0.35};
    case LightSide::right: return {1, 0.15, 0.35};
    case LightSide::above: return {0, 1, 0.35};
    case LightSide::below: return {0, -1, 0.35};
    case LightSide::behind: return {0, 0.35, -1};
    case LightSide::left_above: return {-0.6, 0.75, 0.9};
    case LightSide::right_above: return {0.6, 0.75, 0.9};
    case LightSide::left_below: return {-0.6, -0.75, 0.9};
    case LightSide::right_below: return {0.6, -0.75, 0.9};
    case LightSide::left_behind: return {-0.8, 0.5, -0.8};
    case LightSide::right_behind: return {0.8, 0.5, -0.8};
  }
  return {0, 0, 1};
}

// From the viewer to the right, and up; or clockwise from north.
Vec3 by_angles(double azimuth, double elevation, Vec3 zero, Vec3 right, Vec3 up) {
  const double a = radians(azimuth), e = radians(elevation);
  return (zero * std::cos(a) + right * std::sin(a)) * std::cos(e) + up * std::sin(e);
}
Vec3 by_compass(double azimuth, double elevation, const Lighting& l) {
  const Vec3 north = -normalize(l.front), up = normalize(l.up);
  return by_angles(azimuth, elevation, north, cross(north, up), up);
}

void take_way(const LightWay& w, const Lighting& l, PlacedLight& p) {
  const bool angles = w.azimuth || w.elevation;
  p.follows_camera = !angles || w.frame == LightFrame::camera;
  if (!angles) p.way = normalize(way_of(w.from.value_or(LightSide::left_above)));
  else if (p.follows_camera) p.way = by_angles(w.azimuth.value_or(0), w.elevation.value_or(0), {0, 0, 1}, {1, 0, 0}, {0, 1, 0});
  else p.way = by_compass(w.azimuth.value_or(0), w.elevation.value_or(0), l);
}

// Irradiance / radiance of what faces the light at that distance, which points are `radiance` / d^2 of.
double irradiance_factor(const PlacedLight& l, double d) {
  switch (l.shape) {
    case PlacedLight::Shape::point:
    case PlacedLight::Shape::spot: return 1 / (d * d);
    case PlacedLight::Shape::sphere: return d > l.radius ? pi * l.radius * l.radius / (d * d) : pi;
    case PlacedLight::Shape::disc: return pi * l.radius * l.radius / (d * d + l.radius * l.radius);
    case PlacedLight::Shape::rectangle: {
      // Four corners that meet on the axis.
      const double a = l.width / 2 / d, b = l.height / 2 / d, ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
      return 2 * (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb));
    }
    case PlacedLight::Shape::directional:
    case PlacedLight::Shape::sun: break;
  }
  return pi;
}
double radiance_of_power(const PlacedLight& l, double power) {
  switch (l.shape) {
    case PlacedLight::Shape::point: return power / (4 * pi);
    case PlacedLight::Shape::spot: {
      // The integral of its share over the cone.
      const double inner = 1 - std::cos(radians(l.inner)), outer = 1 - std::cos(radians(l.outer));
      return power / (2 * pi * (inner + (outer - inner) / 3));
    }
    case PlacedLight::Shape::sphere: return power / (4 * pi * pi * l.radius * l.radius);
    case PlacedLight::Shape::disc: return power / (pi * pi * l.radius * l.radius);
    case PlacedLight::Shape::rectangle: return power / (pi * l.width * l.height);
    case PlacedLight::Shape::directional:
    case PlacedLight::Shape::sun: break;
  }
  return power;
}

// Of a light of this world whose size is known.
void take_place(const LightPlace& place, const LightStrength& strength, const Lighting& l, const Box3& box, double diagonal,
                PlacedLight& p) {
  const Vec3 middle = box.empty() ? Vec3() : box.center();
  p.about = p.target = place.target.value_or(middle);
  if (place.position) {
    p.way = *place.position - p.about, p.follows_camera = false;
    // In the very middle it faces what is below.
    if (!(length(p.way) > 0)) p.target = p.about - l.up * diagonal;
  } else {
    take_way(place.way, l, p);
    p.way *= place.distance * diagonal;
  }
  const double d = std::max(length(p.way), 1e-3 * diagonal), factor = irradiance_factor(p, d);
  p.color = light_color(strength.color);
  p.radiance = strength.power ? radiance_of_power(p, *strength.power) : pi * strength.brightness / factor;
  p.brightness = p.radiance * factor / pi;
}

double diagonal_of(const Box3& box) {
  const double d = box.empty() ? 0 : box.diagonal();
  return d > 0 && std::isfinite(d) ? d : 1;
}

constexpr double usual_inner = 0.7;  // of the angle of a spot
constexpr double shoulder = -50;     // degrees to the right of the viewer

void take_sun(double elevation, std::optional<double> azimuth, const Lighting& l, PlacedLight& p) {
  p.shape = PlacedLight::Shape::sun, p.elevation = elevation, p.azimuth_follows = p.follows_camera = !azimuth;
  p.way = azimuth ? by_compass(*azimuth, elevation, l) : by_angles(shoulder, elevation, {0, 0, 1}, {1, 0, 0}, {0, 1, 0});
}

}  // namespace

std::vector<PlacedLight> place_lights(const Lighting& l, const Box3& box) {
  const double diagonal = diagonal_of(box);
  std::vector<PlacedLight> placed;
  for (const LightParams& light : l.lights) {
    PlacedLight p;
    std::visit(Overloaded{[&](const PointLightParams& s) {
                            p.shape = PlacedLight::Shape::point;
                            take_place(s.place, s.strength, l, box, diagonal, p);
                          },
                          [&](const SpotLightParams& s) {
                            p.shape = PlacedLight::Shape::spot, p.outer = s.angle / 2;
                            p.inner = std::min(s.inner.value_or(usual_inner * s.angle), s.angle) / 2;
                            take_place(s.place, s.strength, l, box, diagonal, p);
                          },
                          [&](const FileLightParams&) {},
                          [&](const DirectionalLightParams& s) {
                            p.shape = PlacedLight::Shape::directional;
                            if (s.direction) p.way = normalize(*s.direction), p.follows_camera = false;
                            else take_way(s.way, l, p);
                            p.color = light_color(s.color), p.brightness = s.brightness, p.angle = s.angle;
                          },
                          [&](const SphereLightParams& s) {
                            p.shape = PlacedLight::Shape::sphere, p.radius = s.radius.value_or(s.size / 2 * diagonal);
                            take_place(s.place, s.strength, l, box, diagonal, p);
                          },
                          [&](const DiscLightParams& s) {
                            p.shape = PlacedLight::Shape::disc, p.radius = s.radius.value_or(s.size / 2 * diagonal);
                            take_place(s.place, s.strength, l, box, diagonal, p);
                          },
                          [&](const RectangleLightParams& s) {
                            p.shape = PlacedLight::Shape::rectangle;
                            p.width = s.width.value_or(s.size.front() * diagonal), p.height = s.height.value_or(s.size.back() * diagonal);
                            take_place(s.place, s.strength, l, box, diagonal, p);
                          },
                          [&](const SunLightParams& s) {
                            take_sun(s.elevation, s.azimuth, l, p);
                            p.brightness = s.brightness, p.haze = s.haze;
                          }},
               light);
    if (!std::holds_alternative<FileLightParams>(light)) placed.push_back(p);
  }
  return placed;
}

PlacedLight place_sun(const Lighting& l, const SkyEnvironmentParams& sky) {
  const SunLightParams* stated = nullptr;
  for (const LightParams& light : l.lights)
    if (const auto* sun = std::get_if<SunLightParams>(&light); sun && !stated) stated = sun;
  PlacedLight p;
  const SunLightParams usual;
  take_sun(sky.elevation.value_or(stated ? stated->elevation : usual.elevation),
           sky.azimuth ? sky.azimuth
           : stated    ? stated->azimuth
                       : std::nullopt,
           l, p);
  p.brightness = sky.brightness, p.haze = sky.haze;
  return p;
}

Vec3 world_way(const PlacedLight& p, const Lighting& l, Vec3 right, Vec3 up, Vec3 forward) {
  const Vec3 w = normalize(p.follows_camera ? right * p.way.x + up * p.way.y - forward * p.way.z : p.way);
  if (!p.azimuth_follows) return w;
  // Turned about the vertical alone: as high as it is stated, whichever way the viewer looks.
  const Vec3 vertical = normalize(l.up), towards = -forward - vertical * dot(-forward, vertical);
  const Vec3 level = length(towards) > 1e-3 ? normalize(towards) : -normalize(l.front);
  return by_angles(shoulder, p.elevation, level, cross(vertical, level), vertical);
}

}  // namespace sg
