// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "render/trace/integrators/integrator.h"
#include "render/trace/integrators/roulette.h"
#include "render/trace/integrators/shadow_rays.h"
#include "render/trace/integrators/subsurface_walk.h"
#include "render/trace/light/fade.h"
#include "render/trace/light/luminance.h"
#include "render/trace/sampling/mis.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

bool is_dark(Vec3f c) { return !(c.x > 0 || c.y > 0 || c.z > 0); }
float most(Vec3f c) { return std::max({c.x, c.y, c.z}); }
/// How a ray opens that stands for all those drawn with about its density: a part of them, so that what they see together is not blurred.
float opening_of(float pdf) { return std::min(0.1f / std::sqrt(std::max(pdf, 1e-6f)), 0.25f); }

/// A path on its way.
struct Path {
  Ray ray;
  Vec3f throughput{1, 1, 1};
  Insides insides;                    // the bodies that it is in
  float pdf = infinite;               // of the last turn; of deltas and the camera infinite: lights are met by chance alone
  bool straight = true;               // from the camera on, through what is translucent
  Vec3f turned_at;                    // where the direction was drawn
  float since = 0;                    // and how far the path has come
  int turns = 0, turns_in_media = 0;  // of these
  float share = 1;                    // of the pixel that it stands for

  RayFootprint footprint;
  Path(const Ray& first, const RayFootprint& pixel) : ray(first), turned_at(first.origin), footprint(pixel) {}
  int bounces() const { return turns - turns_in_media; }

  void turn(Vec3f from, Vec3f direction, float density) {
    ++turns, straight = false, pdf = density, turned_at = from, since = 0;
    ray = {from, direction, infinite};
  }
  void go_straight(Vec3f from, float length) { since += length, ray = {from, ray.direction, infinite}; }
};

/// What a path is followed with, and what for.
struct Following {
  const World& world;
  MediaWalk* media;  // or null
  Sampler& sampler;
  ShadowRays* shadows;  // where rays to lights may wait, or null
  Estimate& out;
};

class PathIntegrator : public Integrator {
 public:
  explicit PathIntegrator(int bounces, bool mirrors_only) : bounces_(bounces), mirrors_only_(mirrors_only) {}

  Estimate along(const World& world, const Ray& first, Sampler& sampler, const RayFootprint& footprint) const override {
    const Media::Borrowed media = world.borrow_media();
    Estimate out;
    const Following f{world, media.get(), sampler, nullptr, out};
    Path path(first, footprint);
    path.insides = world.insides_of_viewer();
    const bool split = media && media->exact();
    if (split) {
      // What the viewer sees of matter, and what is seen through it: both, as far as there is of each.
      Hit hit;
      path.ray.t_max = world.geometry().nearest(first, hit) ? hit.t : infinite;
      const float passes = media->passes_exactly(path.ray);
      if (passes < 1) {
        const float u = sampler.next();
        RandomStream random(sampler.stream());
        Path scattered = path;
        scattered.share = 1 - passes, scattered.throughput = scattered.throughput * scattered.share;
        const auto matter = media->collide_surely(u, random);
        if (matter && scatter(f, *matter, scattered)) follow(f, scattered, false);
      }
      path.share = passes, path.throughput = path.throughput * passes;
      if (!(passes > 0)) return out;
    }
    follow(f, path, split);
    return out;
  }

  // A turn of all of them, then the next one: their first rays go about the same way, those to the lights wait for each other.
  void along_all(const World& world, std::span<const CameraPath> first, Sampler& sampler, Estimate* estimates) const override {
    if (world.has_media()) return Integrator::along_all(world, first, sampler, estimates);
    std::vector<Path> paths;
    paths.reserve(first.size());
    uint32_t dimension[most_paths];
    uint64_t going = 0;
    for (size_t i = 0; i < first.size(); ++i) {
      paths.emplace_back(first[i].ray, first[i].footprint).insides = world.insides_of_viewer();
      dimension[i] = first[i].dimension, estimates[i] = {}, going |= uint64_t(1) << i;
    }
    Hit hits[most_paths];
    uint64_t met = first_hits(world.geometry(), first, hits);
    ShadowRays shadows(world.geometry());
    for (;;) {
      for (uint64_t bits = going; bits; bits &= bits - 1) {
        const auto i = size_t(std::countr_zero(bits));
        const bool hit = met >> i & 1;
        sampler.start(first[i].x, first[i].y, first[i].sample, dimension[i]);
        paths[i].ray.t_max = hit ? hits[i].t : infinite;
        const Following f{world, nullptr, sampler, world.translucent() ? nullptr : &shadows, estimates[i]};
        if (!turn(f, paths[i], hit ? &hits[i] : nullptr, nullptr)) going &= ~(uint64_t(1) << i);
        dimension[i] = sampler.dimension();
      }
      shadows.settle();
      if (going == 0) return;
      met = next_hits(world.geometry(), paths, going, hits);
    }
  }

 private:
  using Integrator::along;

  /// What those that go on meet: bit i where hits[i] was found.
  static uint64_t next_hits(const Geometry& geometry, std::span<const Path> paths, uint64_t going, Hit* hits) {
    Ray rays[most_paths];
    Hit found[most_paths];
    int count = 0;
    for (uint64_t bits = going; bits; bits &= bits - 1) rays[count++] = paths[size_t(std::countr_zero(bits))].ray;
    const uint64_t of_rays = geometry.nearest(rays, count, found);
    uint64_t met = 0;
    for (int k = 0; k < count; ++k, going &= going - 1) {
      const int i = std::countr_zero(going);
      hits[i] = found[k], met |= (of_rays >> k & 1) << i;
    }
    return met;
  }

  /// On to the end. `past_media`: what the path meets of media before the first surface is known.
  void follow(const Following& f, Path& path, bool past_media) const {
    for (;; past_media = false) {
      Hit hit;
      const bool met = f.world.geometry().nearest(path.ray, hit);
      path.ray.t_max = met ? hit.t : infinite;
      std::optional<Collision> matter;
      if (f.media && !past_media) {
        const float u = f.sampler.next();
        RandomStream random(f.sampler.stream());
        matter = f.media->collide(path.ray, u, random);
        if (matter) path.ray.t_max = matter->t;
      }
      if (!turn(f, path, met ? &hit : nullptr, matter ? &*matter : nullptr)) break;
    }
  }

  /// On from what is met first, a surface or matter before it, or neither; false where the path ends.
  bool turn(const Following& f, Path& path, const Hit* hit, const Collision* matter) const {
    const Vec3f absorption = path.insides.absorption();
    if (!path.straight) {
      const Ray seen{path.turned_at, path.ray.direction, path.since + path.ray.t_max};
      f.out.radiance += path.throughput * f.world.lamps().seen(seen, path.since, path.pdf, absorption);
    } else if (!hit && !matter) {
      f.out.passed = luminance(path.throughput);
    }
    if (!hit && !matter) return false;
    path.throughput = path.throughput * fade(absorption, path.ray.t_max);
    return matter ? scatter(f, *matter, path) : meet(f, *hit, path);
  }

  /// On from a surface; false where the path ends.
  bool meet(const Following& f, const Hit& hit, Path& path) const {
    const World& world = f.world;
    Sampler& sampler = f.sampler;
    const Vertex v = world.at(path.ray, hit, path.footprint, !mirrors_only_, path.insides);
    const Vec3f along = path.ray.direction;
    if (v.hidden) {
      path.insides = v.onward(path.insides, along, along);
      path.footprint = path.footprint.after(hit.t);
      path.go_straight(leave(v.point, along), hit.t);
      return true;
    }
    if (!is_dark(v.emission)) {
      const float p =
          world.lamps().triangle_pdf(hit.object, hit.primitive, path.since + hit.t, dot(path.ray.direction, v.point.face_normal));
      f.out.radiance += path.throughput * v.emission * power_weight(path.pdf, p);
    }
    const Vec3f wo = v.frame.to_local(-path.ray.direction);
    const Bsdf::Outgoing outgoing = v.bsdf.outgoing(wo);
    const Lights& lights = mirrors_only_ ? world.lights() : world.lamps();
    if (path.bounces() < bounces_ && lights.asks()) {
      const float choice = sampler.next();
      const Vec2f u = sampler.next2();
      if (!v.bsdf.delta_only()) {
        const auto scattered = [&](Vec3f direction) -> Scattered {
          const Vec3f wi = v.frame.to_local(direction);
          if ((dot(direction, v.point.face_normal) > 0) != (wi.z > 0)) return {};
          return {v.bsdf.evaluate(wo, wi) * std::abs(wi.z), mirrors_only_ ? 0 : v.bsdf.pdf(outgoing, wi)};
        };
        const auto from = [&](Vec3f direction) { return Start{leave(v.point, direction), v.onward(path.insides, along, direction)}; };
        ask_light(f, lights, path.throughput, v.point.position, from, scattered, choice, u);
      }
    }

    // Into the body.
    if (const Vec3f enters = v.bsdf.entering(wo); !is_dark(enters) && path.bounces() < bounces_) {
      const float below = luminance(enters * v.bsdf.base_color()), chance = below / (below + luminance(v.bsdf.albedo(outgoing)));
      if (sampler.next() < chance) {
        RandomStream random(sampler.stream());
        const auto exit = walk_below(world, v, random);
        if (!exit) return false;
        path.throughput = path.throughput * enters * exit->weight / chance;
        return come_out(f, exit->at, path);
      }
      path.throughput = path.throughput / (1 - chance);
    }

    // On to the next surface.
    const float choice = sampler.next();
    const auto s = v.bsdf.sample(outgoing, choice, sampler.next2());
    const uint64_t roulette = sampler.stream();
    if (!s || is_dark(s->weight) || (mirrors_only_ && !s->delta)) return false;
    const bool passes = s->delta && s->transmitted && s->eta == 1 && dot(s->direction, wo) < -0.9999f;
    if (!passes && path.bounces() >= bounces_) return false;  // what is translucent is seen through all the same
    const Vec3f direction = normalize(v.frame.to_world(s->direction));
    // What the shading normal calls one side and the surface the other is no way for light.
    if ((dot(direction, v.point.face_normal) > 0) != (s->direction.z > 0)) return false;
    path.throughput = path.throughput * s->weight;
    const Vec3f from = leave(v.point, direction);
    if (!path.footprint.none()) {
      path.footprint = path.footprint.after(hit.t);
      if (s->delta && !s->transmitted) path.footprint = path.footprint.mirrored(v.point.shading_normal);
      else if (!passes) path.footprint = path.footprint.turned(direction, s->delta ? 0 : opening_of(s->pdf));
    }
    if (s->crossed) path.insides = v.onward(path.insides, along, direction);
    if (passes) path.go_straight(from, hit.t);
    else path.turn(from, direction, s->delta ? infinite : s->pdf);
    return survives(path, path.turns, roulette);
  }

  /// On from where light leaves a body in which it wandered; false where the path ends.
  bool come_out(const Following& f, const Vertex& v, Path& path) const {
    Sampler& sampler = f.sampler;
    const auto scattered = [&](Vec3f direction) -> Scattered {
      const Vec3f wi = v.frame.to_local(direction);
      if (!(wi.z > 0) || !(dot(direction, v.point.face_normal) > 0)) return {};
      const float density = wi.z / std::numbers::pi_v<float>, share = v.bsdf.leaving(wi) * density;
      return {{share, share, share}, density};
    };
    const auto from = [&](Vec3f direction) { return Start{leave(v.point, direction), path.insides}; };
    if (const Lights& lights = f.world.lamps(); lights.asks()) {
      const float choice = sampler.next();
      const Vec2f u = sampler.next2();
      ask_light(f, lights, path.throughput, v.point.position, from, scattered, choice, u);
    }

    const Vec3f direction = normalize(v.frame.to_world(cosine_hemisphere(sampler.next2())));
    const uint64_t roulette = sampler.stream();
    const Scattered s = scattered(direction);
    if (!(s.pdf > 0)) return false;
    path.throughput = path.throughput * s.share / s.pdf;
    if (!path.footprint.none()) path.footprint = path.footprint.turned(direction, opening_of(s.pdf));
    path.turn(leave(v.point, direction), direction, s.pdf);
    return survives(path, path.turns, roulette);
  }

  /// On from a place in a volume; false where the path ends.
  bool scatter(const Following& f, const Collision& c, Path& path) const {
    Sampler& sampler = f.sampler;
    f.out.radiance += path.throughput * c.emission;
    path.throughput = path.throughput * c.albedo;
    if (is_dark(path.throughput) || path.turns_in_media >= matter_turns * bounces_) return false;
    const bool last = c.last || mirrors_only_;
    const Vec3f along = path.ray.direction, from = c.start(path.ray.origin + along * c.t);
    const auto scattered = [&](Vec3f direction) -> Scattered {
      const float density = c.density(along, direction);
      return {{density, density, density}, last ? 0 : density};
    };
    const auto start = [&](Vec3f) { return Start{from, path.insides}; };
    if (const Lights& lights = last ? f.world.lights() : f.world.lamps(); lights.asks()) {
      const float choice = sampler.next();
      const Vec2f u = sampler.next2();
      ask_light(f, lights, path.throughput, from, start, scattered, choice, u);
    }

    const Vec2f v = sampler.next2();
    const uint64_t roulette = sampler.stream();
    if (last) return false;
    const Vec3f direction = c.sample(along, v);
    const float pdf = c.density(along, direction);
    if (!path.footprint.none()) path.footprint = path.footprint.after(c.t).turned(direction, opening_of(pdf));
    path.turn(from, direction, pdf), ++path.turns_in_media;
    return survives(path, 0, roulette);  // matter may scatter any number of times
  }

  static bool survives(Path& path, int turns, uint64_t stream) {
    const float stay = chance_to_go_on(most(path.throughput) / path.share, turns);
    if (stay >= 1) return true;
    if (RandomStream(stream).next() >= stay) return false;
    path.throughput = path.throughput / stay;
    return true;
  }

  /// What goes on of light from a direction, and the density with which the path would turn there: 0 where it would not.
  struct Scattered {
    Vec3f share;  ///< with the cosine of a surface
    float pdf = 0;
  };
  /// Of a ray to a light.
  struct Start {
    Vec3f origin;
    Insides insides;
  };
  /// Of one of the lights, chosen by its power, what is not stopped on its way. `from(direction)`: where rays to it start.
  template <class From, class F>
  void ask_light(const Following& f, const Lights& lights, Vec3f throughput, Vec3f position, From&& from, F&& scattered, float choice,
                 Vec2f u) const {
    const uint64_t stream = f.media ? f.sampler.stream() : 0;
    const auto light = lights.sample(position, choice, u);
    if (!light) return;
    const Scattered s = scattered(light->direction);
    if (is_dark(s.share)) return;
    const Vec3f contribution = s.share * light->radiance * (1 / light->pdf);
    if (is_dark(contribution)) return;
    const float weight = light->delta ? 1 : power_weight(light->pdf, s.pdf);
    // Up to the light's own surface, which is an item or is not.
    const Start start = from(light->direction);
    const Ray ray{start.origin, light->direction, light->distance * (1 - 1e-4f)};
    if (f.shadows) {
      f.shadows->add(ray, throughput * (contribution * fade(start.insides.absorption(), ray.t_max) * weight), f.out.radiance);
      return;
    }
    Vec3f passes = f.world.passes(ray, start.insides);
    if (is_dark(passes)) return;
    if (f.media) {
      RandomStream random(stream);
      passes = passes * f.media->passes(ray, random);
    }
    f.out.radiance += throughput * (contribution * passes * weight);
  }

  int bounces_;
  bool mirrors_only_;
};

}  // namespace

std::unique_ptr<Integrator> path_integrator(int bounces) { return std::make_unique<PathIntegrator>(bounces, false); }
std::unique_ptr<Integrator> whitted_integrator(int bounces) { return std::make_unique<PathIntegrator>(bounces, true); }

}  // namespace sg::trace
