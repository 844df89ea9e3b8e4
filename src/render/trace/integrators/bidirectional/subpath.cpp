// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/bidirectional/subpath.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/trace/light/fade.h"
#include "render/trace/light/luminance.h"

namespace sg::trace {

namespace {

constexpr float no_end = std::numeric_limits<float>::infinity();

bool carries(Vec3f c) { return c.x > 0 || c.y > 0 || c.z > 0; }

class Walk {
 public:
  Walk(const PathScene& scene, Transport transport, int levels, Numbers& numbers, SubPath& path)
      : scene_(scene), transport_(transport), levels_(levels), numbers_(numbers), path_(path) {}

  void go(Ray ray, Vec3f throughput, Insides insides) {
    const World& world = scene_.world;
    const bool from_camera = transport_ == Transport::radiance;
    Vec3f turned_at = ray.origin;
    float since = 0;
    double pdf = 0;  // of the direction since the last turn
    for (int last = -1;;) {
      Hit hit;
      const float end = ray.t_max;
      const bool met = world.geometry().nearest(ray, hit);
      ray.t_max = met ? hit.t : end;
      if (from_camera && last >= 0)
        path_.stretches.push_back({last, {turned_at, ray.direction, since + ray.t_max}, since, pdf, throughput, insides.absorption()});
      if (!met) {
        if (from_camera && last < 0) path_.passed = luminance(throughput);
        return;
      }
      throughput = throughput * fade(insides.absorption(), hit.t);

      PathVertex v;
      v.at = world.at(ray, hit, {}, false, insides);
      if (v.at.hidden) {
        insides = v.at.onward(insides, ray.direction, ray.direction);
        since += hit.t;
        ray = {leave(v.at.point, ray.direction), ray.direction, end - hit.t};
        continue;
      }
      v.parent = last, v.level = last < 0 ? 1 : path_.vertex(last).level + 1;
      v.to_parent = -ray.direction, v.distance = since + hit.t;
      v.throughput = throughput, v.around = insides;
      v.forward = forward_density(v, pdf);
      if (last < 0 && from_camera) path_.straight += throughput * v.at.emission;
      const int here = int(path_.vertices.size());
      path_.vertices.push_back(v);

      const Vec3f wo = v.local_parent();
      const float choice = numbers_.next();
      const auto s = v.at.bsdf.sample(wo, choice, numbers_.next2(), transport_);
      const float roulette = scene_.roulette ? numbers_.next() : 0;
      if (!s || !carries(s->weight)) return;
      const bool passes = s->delta && s->transmitted && s->eta == 1 && dot(s->direction, wo) < -0.9999f;
      if (!passes && v.level >= levels_) return;
      const Vec3f direction = normalize(v.at.frame.to_world(s->direction));
      if ((dot(direction, v.at.point.face_normal) > 0) != (s->direction.z > 0)) return;
      throughput = throughput * s->weight;
      const Vec3f from = leave(v.at.point, direction);
      if (s->crossed) insides = v.insides_along(direction);
      if (passes) {
        since += hit.t;
        ray = {from, direction, end - hit.t};
      } else {
        if (!from_camera) throughput = throughput * rounded_normal_factor(v.at, wo, v.to_parent, s->direction, direction);
        path_.vertices[size_t(here)].delta = s->delta;
        set_reverse(v, s->delta ? double(std::abs(wo.z)) : double(v.at.bsdf.pdf(s->direction, wo)));
        pdf = s->delta ? double(s->eta) * double(s->eta) * double(std::abs(s->direction.z)) : double(s->pdf);
        last = here, since = 0, turned_at = from;
        ray = {from, direction, no_end};
      }
      if (scene_.roulette && v.level > 3) {
        const float stay = std::min(0.95f, std::max({throughput.x, throughput.y, throughput.z}) / start_);
        if (roulette >= stay) return;
        throughput = throughput / stay;
      }
    }
  }
  /// What a path carries at its start, by which the roulette judges what is left.
  void starts_with(Vec3f throughput) { start_ = std::max({throughput.x, throughput.y, throughput.z}); }

 private:
  double forward_density(const PathVertex& v, double pdf) const {
    const Vec3f normal = v.at.point.face_normal;
    if (v.parent >= 0) return per_area(pdf, normal, v.to_parent, v.distance);
    if (transport_ == Transport::radiance)
      return scene_.camera.importance(v.at.point.position) * double(std::abs(dot(normal, v.to_parent))) / scene_.camera.pixels();
    const EmittedRay& e = *path_.emitted;
    return e.at_infinity ? double(e.second) * double(std::abs(dot(normal, v.to_parent)))
                         : per_area(double(e.second), normal, v.to_parent, v.distance);
  }
  // Of the vertex before, seen from v, which goes on.
  void set_reverse(const PathVertex& v, double pdf) {
    if (v.parent >= 0) {
      PathVertex& p = path_.vertices[size_t(v.parent)];
      p.reverse = per_area(pdf, p.at.point.face_normal, v.to_parent, v.distance);
    } else if (transport_ == Transport::importance) {
      path_.light_reverse = path_.emitted->at_infinity ? pdf : per_area(pdf, path_.emitted->normal, v.to_parent, v.distance);
    }
  }

  const PathScene& scene_;
  Transport transport_;
  int levels_;
  float start_ = 1;
  Numbers& numbers_;
  SubPath& path_;
};

void clear(SubPath& path) {
  path.vertices.clear(), path.stretches.clear();
  path.straight = {}, path.passed = 0, path.light_reverse = 0;
  path.emitted.reset();
}

}  // namespace

double per_area(double per_solid_angle, Vec3f normal, Vec3f direction, float distance) {
  const double cosine = normal == Vec3f() ? 1 : double(std::abs(dot(normal, direction)));
  return per_solid_angle * cosine / (double(distance) * double(distance));
}

float rounded_normal_factor(const Vertex& v, Vec3f local_to_light, Vec3f to_light, Vec3f local_out, Vec3f out) {
  const Vec3f n = v.point.face_normal;
  if (n == v.frame.z || n == -v.frame.z) return 1;
  const float below = std::abs(dot(to_light, n) * local_out.z);
  return below > 0 ? std::abs(local_to_light.z * dot(out, n)) / below : 0;
}

void walk_from_camera(const PathScene& scene, Vec2f pixel, int levels, Numbers& numbers, SubPath& path) {
  clear(path);
  path.pixel = pixel;
  Walk(scene, Transport::radiance, levels, numbers, path).go(scene.camera.ray(pixel), {1, 1, 1}, scene.world.insides_of_viewer());
}

void walk_from_light(const PathScene& scene, int levels, Numbers& numbers, SubPath& path) {
  clear(path);
  const float choice = numbers.next();
  const Vec2f u = numbers.next2();
  path.emitted = scene.emission.sample(choice, u, numbers.next2());
  if (!path.emitted || levels < 1) return;
  Walk walk(scene, Transport::importance, levels, numbers, path);
  walk.starts_with(path.emitted->weight);
  const EmittedRay& e = *path.emitted;
  walk.go({e.leaves, e.direction, e.t_max}, e.weight, e.at_infinity ? Insides() : scene.world.insides_at(e.leaves, e.direction));
  // Of lights at infinity the disc that their rays start from is no place that anything is at.
  if (path.emitted->at_infinity)
    for (PathVertex& v : path.vertices)
      if (v.parent < 0) v.distance = no_end;
}

}  // namespace sg::trace
