// SPDX-License-Identifier: Apache-2.0
#include "render/trace/light/lights.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/overloaded.h"
#include "render/prepare/picture_set.h"
#include "render/trace/light/fade.h"
#include "render/trace/light/luminance.h"
#include "render/trace/sampling/local_frame.h"
#include "render/trace/sampling/mis.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

float power(const AnyLight& light, float reach) {
  const float disc = pi * reach * reach;
  return std::visit(
      Overloaded{[&](const PointLight& l) { return 4 * pi * luminance(l.intensity); },
                 [&](const SpotLight& l) { return 2 * pi * (l.inner + (l.outer - l.inner) / 3) * luminance(l.intensity); },
                 [&](const DistantLight& l) { return disc * luminance(l.irradiance); },
                 [&](const SphereLight& l) { return 4 * pi * l.radius * l.radius * pi * luminance(l.radiance); },
                 [&](const DiscLight& l) { return pi * l.radius * l.radius * pi * luminance(l.radiance); },
                 [&](const RectangleLight& l) { return length(cross(l.u, l.v)) * pi * luminance(l.radiance); },
                 [&](const TriangleLight& l) { return length(cross(l.b - l.a, l.c - l.a)) * pi * luminance(l.radiance) * l.share; }},
      light);
}

std::optional<LightSample> sharp(Vec3f direction, float distance, Vec3f irradiance) {
  return LightSample{direction, distance, irradiance, 1, true};
}

/// A point of a flat light, drawn evenly with the density 1 / area.
std::optional<LightSample> flat(Vec3f from, Vec3f at, Vec3f normal, float area, Vec3f radiance, bool both_sides) {
  const Vec3f way = at - from;
  const float d2 = dot(way, way), d = std::sqrt(d2);
  if (!(d > 0)) return {};
  const Vec3f direction = way / d;
  const float cosine = -dot(direction, normal);
  if (both_sides ? cosine == 0 : cosine <= 0) return {};
  return LightSample{direction, d, radiance, solid_angle_pdf(1 / area, d2, cosine), false};
}

std::optional<LightSample> sample_one(const PointLight& l, Vec3f from, Vec2f) {
  const Vec3f way = l.position - from;
  const float d2 = dot(way, way), d = std::sqrt(d2);
  if (!(d > 0)) return {};
  return sharp(way / d, d, l.intensity / d2);
}
std::optional<LightSample> sample_one(const SpotLight& l, Vec3f from, Vec2f) {
  const Vec3f way = l.position - from;
  const float d2 = dot(way, way), d = std::sqrt(d2);
  if (!(d > 0)) return {};
  const float share = l.share(-way / d);
  if (!(share > 0)) return {};
  return sharp(way / d, d, l.intensity * (share / d2));
}
std::optional<LightSample> sample_one(const DistantLight& l, Vec3f, Vec2f u) {
  if (l.rise == 0) return sharp(l.direction, infinite, l.irradiance);
  const float pdf = uniform_cone_pdf(l.rise);
  // The disc's even radiance; a surface that faces it gets L pi sin^2.
  const Vec3f radiance = l.irradiance / (pi * l.rise * (2 - l.rise));
  return LightSample{normalize(LocalFrame::about(l.direction).to_world(uniform_cone(u, l.rise))), infinite, radiance, pdf, false};
}

// The cone that a sphere fills, seen from outside; its rise without cancellation.
float rise_of(const SphereLight& l, float d2) {
  const float sine2 = l.radius * l.radius / d2;
  return sine2 / (1 + std::sqrt(std::max(0.f, 1 - sine2)));
}
/// The first t > 0 at which a ray meets a sphere; infinite where it does not.
float sphere_t(const SphereLight& l, Vec3f origin, Vec3f direction) {
  const Vec3f o = l.middle - origin;
  const float b = dot(o, direction);
  const Vec3f across = o - direction * b;  // the nearest approach, which keeps what b * b - c would lose
  const float h2 = l.radius * l.radius - dot(across, across);
  if (!(h2 >= 0)) return infinite;
  const float h = std::sqrt(h2);
  return b - h > 0 ? b - h : b + h > 0 ? b + h : infinite;
}
std::optional<LightSample> sample_one(const SphereLight& l, Vec3f from, Vec2f u) {
  const Vec3f way = l.middle - from;
  const float d2 = dot(way, way);
  if (d2 <= l.radius * l.radius) {
    // From inside all directions meet it.
    const Vec3f direction = uniform_sphere(u);
    return LightSample{direction, sphere_t(l, from, direction), l.radiance, uniform_sphere_pdf(), false};
  }
  const float rise = rise_of(l, d2);
  const Vec3f direction = normalize(LocalFrame::about(way / std::sqrt(d2)).to_world(uniform_cone(u, rise)));
  float t = sphere_t(l, from, direction);
  if (t == infinite) t = dot(way, direction);  // at its very rim
  return LightSample{direction, t, l.radiance, uniform_cone_pdf(rise), false};
}
float pdf_seen(const SphereLight& l, Vec3f from) {
  const Vec3f way = l.middle - from;
  const float d2 = dot(way, way);
  return d2 <= l.radius * l.radius ? uniform_sphere_pdf() : uniform_cone_pdf(rise_of(l, d2));
}

std::optional<LightSample> sample_one(const DiscLight& l, Vec3f from, Vec2f u) {
  const Vec2f d = concentric_disc(u);
  const LocalFrame frame = LocalFrame::about(l.normal);
  return flat(from, l.middle + frame.x * (d.x * l.radius) + frame.y * (d.y * l.radius), l.normal, pi * l.radius * l.radius, l.radiance,
              false);
}
std::optional<LightSample> sample_one(const RectangleLight& l, Vec3f from, Vec2f u) {
  const Vec3f n = cross(l.u, l.v);
  const float area = length(n);
  return flat(from, l.corner + l.u * u.x + l.v * u.y, n / area, area, l.radiance, false);
}
std::optional<LightSample> sample_one(const TriangleLight& l, Vec3f from, Vec2f u) {
  const Vec3f w = uniform_triangle(u), n = cross(l.b - l.a, l.c - l.a);
  const float twice = length(n);
  return flat(from, l.a * w.x + l.b * w.y + l.c * w.z, n / twice, twice / 2, l.radiance_at(w), true);
}

/// What a ray sees of a light, and the density with which sample_one() draws its direction.
struct Seen {
  Vec3f radiance;
  float pdf, t;
};

/// Where a ray meets a flat light from its shining side.
std::optional<Seen> meet(const Ray& r, Vec3f middle, Vec3f normal, float area, Vec3f radiance, float t_min, auto&& inside) {
  const float cosine = -dot(r.direction, normal);
  if (!(cosine > 0)) return {};
  const float t = dot(r.origin - middle, normal) / cosine;
  if (!(t > t_min && t <= r.t_max) || !inside(r.origin + r.direction * t - middle)) return {};
  return Seen{radiance, solid_angle_pdf(1 / area, t * t, cosine), t};
}
std::optional<Seen> seen_one(const SphereLight& l, const Ray& r, float t_min) {
  const float t = sphere_t(l, r.origin, r.direction);
  if (!(t > t_min && t <= r.t_max) || t == infinite) return {};
  return Seen{l.radiance, pdf_seen(l, r.origin), t};
}
std::optional<Seen> seen_one(const DiscLight& l, const Ray& r, float t_min) {
  return meet(r, l.middle, l.normal, pi * l.radius * l.radius, l.radiance, t_min,
              [&](Vec3f p) { return dot(p, p) <= l.radius * l.radius; });
}
std::optional<Seen> seen_one(const RectangleLight& l, const Ray& r, float t_min) {
  const Vec3f n = cross(l.u, l.v);
  const float area = length(n);
  return meet(r, l.corner, n / area, area, l.radiance, t_min, [&](Vec3f p) {
    const float u = dot(p, l.u) / dot(l.u, l.u), v = dot(p, l.v) / dot(l.v, l.v);
    return u >= 0 && u <= 1 && v >= 0 && v <= 1;
  });
}
std::optional<Seen> seen_one(const DistantLight& l, const Ray& r, float) {
  if (l.rise == 0 || r.t_max != infinite || !(1 - dot(r.direction, l.direction) < l.rise)) return {};
  return Seen{l.irradiance / (pi * l.rise * (2 - l.rise)), uniform_cone_pdf(l.rise), infinite};
}
std::optional<Seen> seen_one(const PointLight&, const Ray&, float) { return {}; }  // without a size
std::optional<Seen> seen_one(const SpotLight&, const Ray&, float) { return {}; }
std::optional<Seen> seen_one(const TriangleLight&, const Ray&, float) { return {}; }  // an item

/// The density of sample_one(); of deltas 1.
float pdf_one(const PointLight&, Vec3f, Vec3f, float) { return 1; }
float pdf_one(const SpotLight&, Vec3f, Vec3f, float) { return 1; }
float pdf_one(const DistantLight& l, Vec3f, Vec3f, float) { return l.rise == 0 ? 1 : uniform_cone_pdf(l.rise); }
float pdf_one(const SphereLight& l, Vec3f from, Vec3f, float) { return pdf_seen(l, from); }
float pdf_flat(Vec3f normal, float area, Vec3f direction, float distance) {
  return solid_angle_pdf(1 / area, distance * distance, dot(direction, normal) / length(normal));
}
float pdf_one(const DiscLight& l, Vec3f, Vec3f direction, float distance) {
  return pdf_flat(l.normal, pi * l.radius * l.radius, direction, distance);
}
float pdf_one(const RectangleLight& l, Vec3f, Vec3f direction, float distance) {
  return pdf_flat(cross(l.u, l.v), length(cross(l.u, l.v)), direction, distance);
}
float pdf_one(const TriangleLight& l, Vec3f, Vec3f direction, float distance) {
  return pdf_flat(cross(l.b - l.a, l.c - l.a), length(cross(l.b - l.a, l.c - l.a)) / 2, direction, distance);
}

uint64_t key_of(uint32_t object, uint32_t primitive) { return uint64_t(object) << 32 | primitive; }

}  // namespace

Vec3f TriangleLight::radiance_at(Vec3f w) const {
  if (!picture) return radiance;
  TexturePlace place;
  for (int k = 0; k < 3; ++k) {
    const float* uv = picture->uv() + 2 * size_t(points[size_t(k)]);
    place.at = place.at + Vec2{double(uv[0]), double(uv[1])} * double(w[k]);
  }
  const Vec4f texel = picture->lookup(*picture->texture, place);
  return radiance * Vec3f{texel.x, texel.y, texel.z};
}

Lights::Lights(std::vector<AnyLight> lights, Environment environment, float reach, bool ask_soft)
    : lights_(std::move(lights)), environment_(std::move(environment)) {
  std::vector<float> powers;
  for (const AnyLight& l : lights_) {
    const float p = power(l, reach);
    if (!(p > 0 && std::isfinite(p)))
      fail_usage("a light has no size or no power", "lights", "give every light a size and a brightness above 0");
    if (const auto* t = std::get_if<TriangleLight>(&l)) triangles_.emplace_back(key_of(t->object, t->primitive), uint32_t(powers.size()));
    else if (!std::holds_alternative<PointLight>(l) && !std::holds_alternative<SpotLight>(l)) met_.push_back(uint32_t(powers.size()));
    powers.push_back(p);
  }
  std::sort(triangles_.begin(), triangles_.end());
  const float around = pi * reach * reach * pi * luminance(environment_.mean());
  if (around > 0 && (ask_soft || !environment_.soft())) {
    // Light from everywhere is half of what is asked for, however bright single lights are: all shadows are filled by it.
    float sum = 0;
    for (const float p : powers) sum += p;
    powers.push_back(std::max(around, sum));
  }
  if (!powers.empty()) choice_.emplace(powers);
}

std::optional<LightSample> Lights::sample(Vec3f from, float choice, Vec2f u) const {
  if (!choice_) return {};
  const Distribution1D::Sample chosen = choice_->sample(choice);
  const float chance = choice_->probability(chosen.cell);
  std::optional<LightSample> s;
  if (chosen.cell == lights_.size()) {
    const Environment::Sample e = environment_.sample(u);
    if (e.pdf > 0) s = LightSample{e.direction, infinite, e.radiance, e.pdf, false};
  } else {
    s = std::visit([&](const auto& l) { return sample_one(l, from, u); }, lights_[chosen.cell]);
  }
  if (s) s->pdf *= chance, s->light = uint32_t(chosen.cell);
  return s;
}

std::optional<uint32_t> Lights::choose(float choice) const {
  if (!choice_) return {};
  return uint32_t(choice_->sample(choice).cell);
}

Vec3f Lights::seen(const Ray& ray, float t_min, float pdf, Vec3f absorption) const {
  Vec3f sum;
  for (const uint32_t i : met_)
    if (const auto s = std::visit([&](const auto& l) { return seen_one(l, ray, t_min); }, lights_[i]))
      sum += s->radiance * fade(absorption, s->t - t_min) * power_weight(pdf, choice_->probability(i) * s->pdf);
  if (ray.t_max == infinite && !environment_.dark())
    sum += environment_.radiance(ray.direction) * fade(absorption, infinite) *
           power_weight(pdf, chance(uint32_t(lights_.size())) * environment_.pdf(ray.direction));
  return sum;
}

void Lights::met(const Ray& ray, float t_min, std::vector<MetLight>& out) const {
  for (const uint32_t i : met_)
    if (const auto s = std::visit([&](const auto& l) { return seen_one(l, ray, t_min); }, lights_[i]))
      out.push_back({i, s->radiance, s->t, choice_->probability(i) * s->pdf});
  const auto around = uint32_t(lights_.size());
  if (ray.t_max == infinite && chance(around) > 0)
    out.push_back({around, environment_.radiance(ray.direction), infinite, chance(around) * environment_.pdf(ray.direction)});
}

float Lights::pdf(uint32_t number, Vec3f from, Vec3f direction, float distance) const {
  if (number == lights_.size()) return chance(number) * environment_.pdf(direction);
  return chance(number) * std::visit([&](const auto& l) { return pdf_one(l, from, direction, distance); }, lights_[number]);
}

std::optional<uint32_t> Lights::number_of(uint32_t object, uint32_t primitive) const {
  const auto at = std::lower_bound(triangles_.begin(), triangles_.end(), std::pair(key_of(object, primitive), uint32_t(0)));
  if (at == triangles_.end() || at->first != key_of(object, primitive)) return {};
  return at->second;
}

float Lights::triangle_pdf(uint32_t object, uint32_t primitive, float distance, float cosine) const {
  const auto number = number_of(object, primitive);
  if (!number) return 0;
  const auto& l = std::get<TriangleLight>(lights_[*number]);
  return chance(*number) * solid_angle_pdf(2 / length(cross(l.b - l.a, l.c - l.a)), distance * distance, cosine);
}

}  // namespace sg::trace
