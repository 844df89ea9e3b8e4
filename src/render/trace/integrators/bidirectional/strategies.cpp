// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/bidirectional/strategies.h"

#include "render/trace/integrators/bidirectional/turn.h"
#include "render/trace/light/fade.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

// The density of the place that a direction leads to, drawn from the other end.
double to_vertex(double per_solid_angle, const PathVertex& v, Vec3f direction, float distance) {
  return v.seen_only() ? 0 : per_area(per_solid_angle, v.normal(), direction, distance);
}

}  // namespace

// From the light: its vertices are x_0, ..., x_level.
void Strategies::take_light(const SubPath& path, int end) {
  PathDensities& d = densities_;
  for (int i = end; i >= 0; i = path.vertex(i).parent) {
    const PathVertex& v = path.vertex(i);
    const auto at = size_t(v.level);
    d.from_light[at] = v.forward, d.from_camera[at] = v.reverse, d.delta[at] = v.delta && i != end;
  }
  d.from_light[0] = double(path.emitted->first), d.from_camera[0] = path.light_reverse;
  d.light_can_be_met = scene_.emission.can_be_met(path.emitted->light);
}

// From the camera, which is the last of all.
void Strategies::take_camera(const SubPath& path, int end) {
  PathDensities& d = densities_;
  const size_t last = d.count() - 1;
  for (int i = end; i >= 0; i = path.vertex(i).parent) {
    const PathVertex& v = path.vertex(i);
    const size_t at = last - size_t(v.level);
    d.from_camera[at] = v.forward, d.from_light[at] = v.reverse, d.delta[at] = v.delta && i != end;
  }
  d.from_camera[last] = 1, d.from_light[last] = 0;
}

double Strategies::asked_density(uint32_t light, Vec3f normal, Vec3f from, Vec3f direction, float distance) const {
  const double pdf = double(scene_.world.lights().pdf(light, from, direction, distance));
  return normal == Vec3f() ? pdf : per_area(pdf, normal, direction, distance);
}

// The densities of x_0 and x_1 that the light alone decides, where the camera's half drew them.
void Strategies::set_light(uint32_t light, Vec3f normal, Vec3f towards_light, const PathVertex& next, float distance) {
  PathDensities& d = densities_;
  const Emission::Densities e = scene_.emission.pdf(light, normal, -towards_light);
  d.from_light[0] = double(e.first);
  if (next.seen_only()) d.from_light[1] = 0;
  else if (scene_.emission.at_infinity(light)) d.from_light[1] = double(e.second) * across(next.normal(), towards_light);
  else d.from_light[1] = per_area(double(e.second), next.normal(), towards_light, distance);
  d.light_can_be_met = scene_.emission.can_be_met(light);
}

// Light that passes from a vertex along a ray.
Vec3f Strategies::passes(const PathVertex& from, const Ray& ray, Numbers& numbers) {
  const uint64_t stream = media_ ? numbers.stream() : 0;
  const Vec3f share = scene_.world.passes(ray, from.insides_along(ray.direction));
  if (!media_ || !shines(share)) return share;
  RandomStream random(stream);
  return share * media_->passes(ray, random);
}

std::optional<Contribution> Strategies::shining(const SubPath& camera, int i) {
  const PathVertex& v = camera.vertex(i);
  const Vec3f value = v.throughput * v.at.emission;
  if (v.level < 2 || !shines(value)) return {};
  densities_.reset(size_t(v.level) + 1);
  take_camera(camera, i);
  const PathVertex& next = camera.vertex(v.parent);
  if (const auto light = scene_.world.lights().number_of(v.at.point.object, v.at.point.primitive)) {
    const Vec3f normal = v.normal();
    set_light(*light, normal, -v.to_parent, next, v.distance);
    densities_.asked = asked_density(*light, normal, next.at.point.position, -v.to_parent, v.distance);
  } else {
    densities_.from_light[0] = densities_.from_light[1] = 0;  // it is met by chance alone
  }
  return Contribution{camera.pixel, value, 0};
}

const std::vector<MetLight>& Strategies::met_in(const Stretch& stretch) {
  met_.clear();
  scene_.world.lights().met(stretch.ray, stretch.t_min, met_);
  return met_;
}

std::optional<Contribution> Strategies::met(const SubPath& camera, const Stretch& stretch, const MetLight& m) {
  const Vec3f way = stretch.ray.direction, value = stretch.throughput * m.radiance * fade(stretch.absorption, m.distance - stretch.t_min);
  if (!shines(value)) return {};
  const PathVertex& next = camera.vertex(stretch.after);
  densities_.reset(size_t(next.level) + 2);
  take_camera(camera, stretch.after);
  densities_.delta[1] = next.delta;
  const bool far = scene_.emission.at_infinity(m.light);
  const Vec3f normal = far ? Vec3f() : scene_.emission.normal(m.light, stretch.ray.origin + way * m.distance);
  set_light(m.light, normal, way, next, m.distance);
  densities_.from_camera[0] = far ? stretch.pdf : per_area(stretch.pdf, normal, way, m.distance);
  densities_.asked = far ? double(m.pdf) : per_area(double(m.pdf), normal, way, m.distance);
  return Contribution{camera.pixel, value, 0};
}

std::optional<Contribution> Strategies::asked(const SubPath& camera, int i, Numbers& numbers) {
  const PathVertex& v = camera.vertex(i);
  if (v.surfaces > scene_.bounces) return {};
  const float choice = numbers.next();
  const Vec2f u = numbers.next2();
  const auto light = scene_.world.lights().sample(v.at.point.position, choice, u);
  if (!light) return {};
  const auto t = turn(v, light->direction, Transport::radiance);
  if (!t) return {};
  Vec3f value = v.throughput * t->scattered * light->radiance / light->pdf;
  if (!shines(value)) return {};
  // Up to the light's own surface, which is an item or is not.
  value = value * passes(v, {v.start(light->direction), light->direction, light->distance * (1 - 1e-4f)}, numbers);
  if (!shines(value)) return {};
  densities_.reset(size_t(v.level) + 2);
  take_camera(camera, i);
  const bool far = scene_.emission.at_infinity(light->light);
  const Vec3f normal = far ? Vec3f() : scene_.emission.normal(light->light, v.at.point.position + light->direction * light->distance);
  set_light(light->light, normal, light->direction, v, light->distance);
  densities_.from_camera[0] = far ? t->onward : per_area(t->onward, normal, light->direction, light->distance);
  densities_.asked = normal == Vec3f() ? double(light->pdf) : per_area(double(light->pdf), normal, light->direction, light->distance);
  if (v.parent >= 0) densities_.from_light[2] = to_vertex(t->backward, camera.vertex(v.parent), v.to_parent, v.distance);
  return Contribution{camera.pixel, value, 1};
}

std::optional<Contribution> Strategies::joined(const SubPath& light, int i, const SubPath& camera, int j, Numbers& numbers) {
  const PathVertex &y = light.vertex(i), &z = camera.vertex(j);
  if (y.surfaces + z.surfaces > scene_.bounces || (z.matter && z.matter->last)) return {};
  const Vec3f way = z.at.point.position - y.at.point.position;
  const float d = length(way);
  if (!(d > 0)) return {};
  const Vec3f direction = way / d;
  const auto at_y = turn(y, direction, Transport::importance);
  if (!at_y) return {};
  const auto at_z = turn(z, -direction, Transport::radiance);
  if (!at_z) return {};
  Vec3f value = y.throughput * at_y->scattered * z.throughput * at_z->scattered / (d * d);
  if (!shines(value)) return {};
  const Vec3f from = y.start(direction), between = z.start(-direction) - from;
  const float free = length(between);
  if (free > 0) value = value * passes(y, {from, between / free, free * (1 - 1e-4f)}, numbers);
  if (!shines(value)) return {};
  densities_.reset(size_t(y.level) + size_t(z.level) + 2);
  take_light(light, i), take_camera(camera, j);
  const auto a = size_t(y.level);
  densities_.from_light[a + 1] = to_vertex(at_y->onward, z, direction, d);
  densities_.from_camera[a] = to_vertex(at_z->onward, y, direction, d);
  if (z.parent >= 0) densities_.from_light[a + 2] = to_vertex(at_z->backward, camera.vertex(z.parent), z.to_parent, z.distance);
  end_light(light, i, at_y->backward);
  return Contribution{camera.pixel, value, y.level + 1};
}

std::optional<Contribution> Strategies::onto_picture(const SubPath& light, int i, Numbers& numbers) {
  const PathVertex& y = light.vertex(i);
  if (y.surfaces > scene_.bounces) return {};
  const Vec2f on_lens = scene_.camera.has_lens() ? concentric_disc(numbers.next2()) : Vec2f();
  const auto sight = scene_.camera.sees(y.at.point.position, on_lens);
  if (!sight) return {};
  const auto t = turn(y, sight->direction, Transport::importance);
  if (!t) return {};
  Vec3f value = y.throughput * t->scattered * (sight->importance / float(scene_.camera.pixels()));
  if (!shines(value)) return {};
  value = value * passes(y, {y.start(sight->direction), sight->direction, sight->distance}, numbers);
  if (!shines(value)) return {};
  densities_.reset(size_t(y.level) + 2);
  take_light(light, i);
  const auto a = size_t(y.level);
  densities_.from_camera[a + 1] = 1;
  densities_.from_camera[a] = double(sight->importance) * across(y.normal(), sight->direction) / scene_.camera.pixels();
  end_light(light, i, t->backward);
  return Contribution{sight->pixel, value, y.level + 1};
}

// What the end of the light's half draws backwards, and how its first vertex would ask for the light.
void Strategies::end_light(const SubPath& light, int i, double backward) {
  PathDensities& d = densities_;
  const PathVertex& y = light.vertex(i);
  const EmittedRay& e = *light.emitted;
  if (y.parent >= 0) d.from_camera[size_t(y.level) - 1] = to_vertex(backward, light.vertex(y.parent), y.to_parent, y.distance);
  else d.from_camera[0] = e.at_infinity ? backward : per_area(backward, e.normal, y.to_parent, y.distance);
  int first = i;
  while (light.vertex(first).parent >= 0) first = light.vertex(first).parent;
  const PathVertex& v = light.vertex(first);
  d.asked = asked_density(e.light, e.normal, v.at.point.position, v.to_parent, v.distance);
}

}  // namespace sg::trace
