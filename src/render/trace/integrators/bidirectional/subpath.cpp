// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/bidirectional/subpath.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/trace/integrators/roulette.h"
#include "render/trace/light/fade.h"
#include "render/trace/light/luminance.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

constexpr float no_end = std::numeric_limits<float>::infinity();
constexpr uint32_t no_object = std::numeric_limits<uint32_t>::max();

bool carries(Vec3f c) { return c.x > 0 || c.y > 0 || c.z > 0; }

class Walk {
 public:
  Walk(const PathScene& scene, MediaWalk* media, Transport transport, int levels, Numbers& numbers, SubPath& path)
      : scene_(scene), media_(media), transport_(transport), levels_(levels), numbers_(numbers), path_(path) {}

  void go(const Ray& first, Vec3f throughput, const Insides& insides) {
    ray_ = first, throughput_ = throughput, insides_ = insides, turned_at_ = first.origin;
    while (step()) {
    }
  }
  /// What a path carries at its start, by which the roulette judges what is left.
  void starts_with(Vec3f throughput) { start_ = std::max({throughput.x, throughput.y, throughput.z}); }

 private:
  bool from_camera() const { return transport_ == Transport::radiance; }

  // On to the next surface or place in a medium, and to a direction from there; false where the path ends.
  bool step() {
    const World& world = scene_.world;
    Hit hit;
    const float end = ray_.t_max;
    const bool met = world.geometry().nearest(ray_, hit);
    ray_.t_max = met ? hit.t : end;
    std::optional<Collision> matter;
    if (media_) {
      const float u = numbers_.next();
      RandomStream random(numbers_.stream());
      matter = media_->collide(ray_, u, random);
      if (matter) ray_.t_max = matter->t;
    }
    if (from_camera() && last_ >= 0)
      path_.stretches.push_back(
          {last_, {turned_at_, ray_.direction, since_ + ray_.t_max}, since_, pdf_, throughput_, insides_.absorption()});
    if (!met && !matter) {
      if (from_camera() && last_ < 0) path_.passed = luminance(throughput_);
      return false;
    }
    throughput_ = throughput_ * fade(insides_.absorption(), ray_.t_max);
    if (matter) return scatter(*matter);

    PathVertex v;
    v.at = world.at(ray_, hit, {}, false, insides_);
    if (v.at.hidden) {
      insides_ = v.at.onward(insides_, ray_.direction, ray_.direction);
      go_straight(leave(v.at.point, ray_.direction), hit.t, end);
      return true;
    }
    return meet(v, hit.t, end);
  }

  // On from a surface.
  bool meet(PathVertex& v, float t, float end) {
    const int here = add(v, t, 1);
    const Vec3f wo = v.local_parent();
    const float choice = numbers_.next();
    const auto s = v.at.bsdf.sample(wo, choice, numbers_.next2(), transport_);
    const float roulette = scene_.roulette ? numbers_.next() : 0;
    if (!s || !carries(s->weight)) return false;
    const bool passes = s->delta && s->transmitted && s->eta == 1 && dot(s->direction, wo) < -0.9999f;
    if (!passes && (v.level >= levels_ || v.surfaces > scene_.bounces)) return false;
    const Vec3f direction = normalize(v.at.frame.to_world(s->direction));
    if ((dot(direction, v.normal()) > 0) != (s->direction.z > 0)) return false;
    throughput_ = throughput_ * s->weight;
    if (s->crossed) insides_ = v.insides_along(direction);
    if (passes) {
      go_straight(v.start(direction), t, end);
    } else {
      if (!from_camera()) throughput_ = throughput_ * rounded_normal_factor(v.at, wo, v.to_parent, s->direction, direction);
      path_.vertices[size_t(here)].delta = s->delta;
      set_reverse(v, s->delta ? double(std::abs(wo.z)) : double(v.at.bsdf.pdf(s->direction, wo)));
      turn(here, v.start(direction), direction,
           s->delta ? double(s->eta) * double(s->eta) * double(std::abs(s->direction.z)) : double(s->pdf));
    }
    return survives(v.level, roulette);
  }

  // On from a place in a medium.
  bool scatter(const Collision& c) {
    if (!from_camera() && (c.on_surface || (c.last && last_ >= 0))) return false;
    PathVertex v;
    v.matter = c;
    v.at.point.position = c.start(ray_.origin + ray_.direction * c.t), v.at.point.object = no_object;
    v.at.emission = c.emission;
    const int here = add(v, c.t, 0);
    const Vec2f u = numbers_.next2();
    const float roulette = scene_.roulette ? numbers_.next() : 0;
    if (v.level >= levels_ || v.surfaces > scene_.bounces || !carries(c.albedo) || (c.last && from_camera())) return false;
    throughput_ = throughput_ * c.albedo;
    const Vec3f direction = c.sample(-v.to_parent, u);
    const double pdf = double(c.density(-v.to_parent, direction));
    set_reverse(v, c.last ? 0 : pdf);
    turn(here, v.at.point.position, direction, pdf);
    return survives(0, roulette);
  }

  // A vertex at the end of a ray that went on by t.
  int add(PathVertex& v, float t, int surfaces) {
    v.parent = last_, v.level = 1, v.surfaces = surfaces;
    if (last_ >= 0) v.level += path_.vertex(last_).level, v.surfaces += path_.vertex(last_).surfaces;
    v.to_parent = -ray_.direction, v.distance = since_ + t;
    v.throughput = throughput_, v.around = insides_;
    v.forward = forward_density(v);
    if (last_ < 0 && from_camera()) path_.straight += throughput_ * v.at.emission;
    path_.vertices.push_back(v);
    return int(path_.vertices.size()) - 1;
  }
  void go_straight(Vec3f from, float t, float end) { since_ += t, ray_ = {from, ray_.direction, end - t}; }
  void turn(int here, Vec3f from, Vec3f direction, double pdf) {
    last_ = here, since_ = 0, turned_at_ = from, pdf_ = pdf;
    ray_ = {from, direction, no_end};
  }
  bool survives(int turns, float u) {
    if (!scene_.roulette) return true;
    const float stay = chance_to_go_on(std::max({throughput_.x, throughput_.y, throughput_.z}) / start_, turns);
    if (u >= stay) return false;
    throughput_ = throughput_ / stay;
    return true;
  }

  double forward_density(const PathVertex& v) const {
    if (v.parent >= 0) return per_area(pdf_, v.normal(), v.to_parent, v.distance);
    if (from_camera())
      return scene_.camera.importance(v.at.point.position, path_.on_lens) * across(v.normal(), v.to_parent) / scene_.camera.pixels();
    const EmittedRay& e = *path_.emitted;
    return e.at_infinity ? double(e.second) * across(v.normal(), v.to_parent)
                         : per_area(double(e.second), v.normal(), v.to_parent, v.distance);
  }
  // Of the vertex before, seen from v, which goes on.
  void set_reverse(const PathVertex& v, double pdf) {
    if (v.parent >= 0) {
      PathVertex& p = path_.vertices[size_t(v.parent)];
      p.reverse = p.seen_only() ? 0 : per_area(pdf, p.normal(), v.to_parent, v.distance);
    } else if (!from_camera()) {
      path_.light_reverse = path_.emitted->at_infinity ? pdf : per_area(pdf, path_.emitted->normal, v.to_parent, v.distance);
    }
  }

  const PathScene& scene_;
  MediaWalk* media_;
  Transport transport_;
  int levels_;
  float start_ = 1;
  Numbers& numbers_;
  SubPath& path_;
  // On the way:
  Ray ray_;
  Vec3f throughput_;
  Insides insides_;
  int last_ = -1;  // vertex that the path turned at
  Vec3f turned_at_;
  float since_ = 0;  // length of the way from there to the ray's origin
  double pdf_ = 0;   // of the direction
};

void clear(SubPath& path) {
  path.vertices.clear(), path.stretches.clear();
  path.on_lens = {}, path.straight = {}, path.passed = 0, path.light_reverse = 0;
  path.emitted.reset();
}

}  // namespace

double across(Vec3f normal, Vec3f direction) { return normal == Vec3f() ? 1 : double(std::abs(dot(normal, direction))); }

double per_area(double per_solid_angle, Vec3f normal, Vec3f direction, float distance) {
  return per_solid_angle * across(normal, direction) / (double(distance) * double(distance));
}

bool shines(Vec3f c) { return (c.x > 0 || c.y > 0 || c.z > 0) && std::isfinite(c.x + c.y + c.z); }

float rounded_normal_factor(const Vertex& v, Vec3f local_to_light, Vec3f to_light, Vec3f local_out, Vec3f out) {
  const Vec3f n = v.point.face_normal;
  if (n == v.frame.z || n == -v.frame.z) return 1;
  const float below = std::abs(dot(to_light, n) * local_out.z);
  return below > 0 ? std::abs(local_to_light.z * dot(out, n)) / below : 0;
}

void walk_from_camera(const PathScene& scene, MediaWalk* media, Vec2f pixel, int levels, Numbers& numbers, SubPath& path) {
  clear(path);
  path.pixel = pixel;
  if (scene.camera.has_lens()) path.on_lens = concentric_disc(numbers.next2());
  Walk(scene, media, Transport::radiance, levels, numbers, path)
      .go(scene.camera.ray(pixel, path.on_lens), {1, 1, 1}, scene.world.insides_of_viewer());
}

void walk_from_light(const PathScene& scene, MediaWalk* media, int levels, Numbers& numbers, SubPath& path) {
  clear(path);
  const float choice = numbers.next();
  const Vec2f u = numbers.next2();
  path.emitted = scene.emission.sample(choice, u, numbers.next2());
  if (!path.emitted || levels < 1) return;
  Walk walk(scene, media, Transport::importance, levels, numbers, path);
  walk.starts_with(path.emitted->weight);
  const EmittedRay& e = *path.emitted;
  walk.go({e.leaves, e.direction, e.t_max}, e.weight, e.at_infinity ? Insides() : scene.world.insides_at(e.leaves, e.direction));
  // Of lights at infinity the disc that their rays start from is no place that anything is at.
  if (path.emitted->at_infinity)
    for (PathVertex& v : path.vertices)
      if (v.parent < 0) v.distance = no_end;
}

}  // namespace sg::trace
