// SPDX-License-Identifier: Apache-2.0
#include "render/trace/light/emission.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "base/overloaded.h"
#include "render/trace/geometry/surface_point.h"
#include "render/trace/sampling/local_frame.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

constexpr float infinite_way = std::numeric_limits<float>::infinity();

/// A place of a light's surface, drawn evenly.
struct Place {
  Vec3f position, normal;
  float area;
};
Place place_on(const SphereLight& l, Vec2f u) {
  const Vec3f n = uniform_sphere(u);
  return {l.middle + n * l.radius, n, 4 * pi * l.radius * l.radius};
}
Place place_on(const DiscLight& l, Vec2f u) {
  const Vec2f d = concentric_disc(u);
  const LocalFrame frame = LocalFrame::about(l.normal);
  return {l.middle + frame.x * (d.x * l.radius) + frame.y * (d.y * l.radius), l.normal, pi * l.radius * l.radius};
}
Place place_on(const RectangleLight& l, Vec2f u) {
  const Vec3f n = cross(l.u, l.v);
  const float area = length(n);
  return {l.corner + l.u * u.x + l.v * u.y, n / area, area};
}
Place place_on(const TriangleLight& l, Vec2f u) {
  const Vec3f w = uniform_triangle(u), n = cross(l.b - l.a, l.c - l.a);
  const float twice = length(n);
  const Vec3 p = Vec3(l.a) * double(w.x) + Vec3(l.b) * double(w.y) + Vec3(l.c) * double(w.z);
  return {Vec3f(p), n / twice, twice / 2};
}

// A ray from a surface of radiance L, `under` of them to the side that the normal does not point to.
EmittedRay from_surface(const Place& p, Vec3f radiance, float under, Vec2f v) {
  const bool below = v.x < under;
  v.x = below ? v.x / under : (v.x - under) / (1 - under);
  const Vec3f local = cosine_hemisphere({std::min(v.x, 0x1.fffffep-1f), v.y});
  const float share = below ? under : 1 - under;
  EmittedRay e{};
  e.position = p.position, e.normal = p.normal;
  e.direction = normalize(LocalFrame::about(below ? -p.normal : p.normal).to_world(local));
  e.first = 1 / p.area, e.second = share * cosine_hemisphere_pdf(local.z);
  e.weight = radiance * (pi * p.area / share), e.t_max = infinite_way;
  return e;
}

// Ends of a ray that leaves a light which is an item: not on the item itself, whose own numbers are rounded otherwise.
Vec3f off_surface(const TriangleLight& l, const Place& p, Vec3f direction) {
  double largest = 0;
  for (const Vec3f& corner : {l.a, l.b, l.c})
    for (int a = 0; a < 3; ++a) largest = std::max(largest, std::abs(double(corner[a])));
  const double more = 4 * half_unit * largest;
  const Rounded r = rounded(Vec3(p.position), {more, more, more});
  SurfacePoint point;
  point.position = r.position, point.error = r.error, point.face_normal = p.normal;
  return leave(point, direction);
}

bool overlaps(const SphereLight& l, const Box3f& box) {
  if (box.empty()) return false;
  float d2 = 0;
  for (int a = 0; a < 3; ++a) {
    const float off = std::max({box.lo[a] - l.middle[a], l.middle[a] - box.hi[a], 0.f});
    d2 += off * off;
  }
  return d2 < l.radius * l.radius;
}

}  // namespace

Emission::Emission(const Lights& lights, const Box3f& scene) : lights_(lights), reach_(1) {
  if (!scene.empty()) middle_ = (scene.lo + scene.hi) * 0.5f, reach_ = length(scene.hi - scene.lo) / 2 * 1.0001f;
  if (!(reach_ > 0)) reach_ = 1;
  // An eighth: what is inside of a spherical light is lit well by its short ways, and mostly nothing is.
  for (size_t i = 0; i < lights.count(); ++i) {
    const auto* sphere = std::get_if<SphereLight>(&lights.light(uint32_t(i)));
    inwards_.push_back(sphere && overlaps(*sphere, scene) ? 0.125f : 0);
  }
}

std::optional<EmittedRay> Emission::from_infinity(uint32_t light, Vec3f towards, Vec3f radiance, float pdf, Vec2f u) const {
  if (!(pdf > 0)) return {};
  const Vec2f d = concentric_disc(u);
  const LocalFrame frame = LocalFrame::about(towards);
  EmittedRay e{};
  e.light = light, e.at_infinity = true, e.direction = -towards;
  e.position = e.leaves = middle_ + (towards + frame.x * d.x + frame.y * d.y) * reach_;
  e.first = pdf, e.second = 1 / (pi * reach_ * reach_), e.weight = radiance / (e.first * e.second), e.t_max = infinite_way;
  return e;
}

std::optional<EmittedRay> Emission::sample(float choice, Vec2f u, Vec2f v) const {
  const auto number = lights_.choose(choice);
  if (!number) return {};
  const uint32_t i = *number;
  std::optional<EmittedRay> ray;
  if (i == lights_.count()) {
    const Environment::Sample s = lights_.environment().sample(v);
    ray = from_infinity(i, s.direction, s.radiance, s.pdf, u);
  } else {
    ray =
        std::visit(Overloaded{[&](const PointLight& l) -> std::optional<EmittedRay> {
                                EmittedRay e{};
                                e.position = e.leaves = l.position, e.direction = uniform_sphere(v);
                                e.first = 1, e.second = uniform_sphere_pdf(), e.weight = l.intensity / e.second, e.t_max = infinite_way;
                                return e;
                              },
                              [&](const SpotLight& l) -> std::optional<EmittedRay> {
                                EmittedRay e{};
                                e.direction = normalize(LocalFrame::about(l.axis).to_world(uniform_cone(v, l.outer)));
                                const float share = l.share(e.direction);
                                if (!(share > 0)) return {};
                                e.position = e.leaves = l.position, e.first = 1, e.second = uniform_cone_pdf(l.outer);
                                e.weight = l.intensity * (share / e.second), e.t_max = infinite_way;
                                return e;
                              },
                              [&](const DistantLight& l) -> std::optional<EmittedRay> {
                                if (l.rise == 0) return from_infinity(i, l.direction, l.irradiance, 1, u);
                                const Vec3f towards = normalize(LocalFrame::about(l.direction).to_world(uniform_cone(v, l.rise)));
                                return from_infinity(i, towards, l.irradiance / (pi * l.rise * (2 - l.rise)), uniform_cone_pdf(l.rise), u);
                              },
                              [&](const SphereLight& l) -> std::optional<EmittedRay> {
                                const Place p = place_on(l, u);
                                EmittedRay e = from_surface(p, l.radiance, inwards(i), v);
                                const float cosine = dot(e.direction, p.normal);
                                if (cosine < 0) e.t_max = -2 * l.radius * cosine;
                                e.leaves = e.position;
                                return e;
                              },
                              [&](const TriangleLight& l) -> std::optional<EmittedRay> {
                                const Place p = place_on(l, u);
                                EmittedRay e = from_surface(p, l.radiance_at(uniform_triangle(u)), 0.5f, v);
                                e.leaves = off_surface(l, p, e.direction);
                                return e;
                              },
                              [&](const auto& l) -> std::optional<EmittedRay> {
                                EmittedRay e = from_surface(place_on(l, u), l.radiance, 0, v);
                                e.leaves = e.position;
                                return e;
                              }},
                   lights_.light(i));
  }
  if (!ray) return {};
  const float chance = lights_.chance(i);
  ray->light = i, ray->first *= chance, ray->weight = ray->weight / chance;
  return ray;
}

Emission::Densities Emission::pdf(uint32_t light, Vec3f normal, Vec3f direction) const {
  const float chance = lights_.chance(light), disc = 1 / (pi * reach_ * reach_);
  if (light == lights_.count()) return {chance * lights_.environment().pdf(-direction), disc};
  const float cosine = dot(direction, normal);
  const auto surface = [&](float area, float under) {
    return Densities{chance / area, (cosine < 0 ? under : 1 - under) * cosine_hemisphere_pdf(std::abs(cosine))};
  };
  return std::visit(Overloaded{[&](const PointLight&) {
                                 return Densities{chance, uniform_sphere_pdf()};
                               },
                               [&](const SpotLight& l) {
                                 return Densities{chance, l.share(direction) > 0 ? uniform_cone_pdf(l.outer) : 0};
                               },
                               [&](const DistantLight& l) {
                                 return Densities{l.rise == 0 ? chance : chance * uniform_cone_pdf(l.rise), disc};
                               },
                               [&](const SphereLight& l) { return surface(4 * pi * l.radius * l.radius, inwards(light)); },
                               [&](const DiscLight& l) { return surface(pi * l.radius * l.radius, 0); },
                               [&](const RectangleLight& l) { return surface(length(cross(l.u, l.v)), 0); },
                               [&](const TriangleLight& l) { return surface(length(cross(l.b - l.a, l.c - l.a)) / 2, 0.5f); }},
                    lights_.light(light));
}

Vec3f Emission::normal(uint32_t light, Vec3f position) const {
  if (light == lights_.count()) return {};
  return std::visit(
      Overloaded{[](const PointLight&) { return Vec3f(); }, [](const SpotLight&) { return Vec3f(); },
                 [](const DistantLight&) { return Vec3f(); }, [&](const SphereLight& l) { return normalize(position - l.middle); },
                 [](const DiscLight& l) { return l.normal; }, [](const RectangleLight& l) { return normalize(cross(l.u, l.v)); },
                 [](const TriangleLight& l) { return normalize(cross(l.b - l.a, l.c - l.a)); }},
      lights_.light(light));
}

bool Emission::at_infinity(uint32_t light) const {
  return light == lights_.count() || std::holds_alternative<DistantLight>(lights_.light(light));
}

bool Emission::can_be_met(uint32_t light) const {
  if (light == lights_.count()) return true;
  const AnyLight& l = lights_.light(light);
  const auto* distant = std::get_if<DistantLight>(&l);
  return distant ? distant->rise > 0 : !std::holds_alternative<PointLight>(l) && !std::holds_alternative<SpotLight>(l);
}

}  // namespace sg::trace
