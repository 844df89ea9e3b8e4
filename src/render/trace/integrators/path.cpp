// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "render/trace/integrators/integrator.h"
#include "render/trace/integrators/roulette.h"
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

class PathIntegrator : public Integrator {
 public:
  explicit PathIntegrator(int bounces, bool mirrors_only) : bounces_(bounces), mirrors_only_(mirrors_only) {}

  Estimate along(const World& world, const Ray& first, Sampler& sampler, const RayFootprint& footprint) const override {
    const Media::Borrowed media = world.borrow_media();
    Estimate out;
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
        if (matter && scatter(world, media.get(), *matter, scattered, sampler, out))
          follow(world, media.get(), scattered, false, sampler, out);
      }
      path.share = passes, path.throughput = path.throughput * passes;
      if (!(passes > 0)) return out;
    }
    follow(world, media.get(), path, split, sampler, out);
    return out;
  }

 private:
  /// On to the end. `past_media`: what the path meets of media before the first surface is known.
  void follow(const World& world, MediaWalk* media, Path& path, bool past_media, Sampler& sampler, Estimate& out) const {
    for (;; past_media = false) {
      Hit hit;
      const bool met = world.geometry().nearest(path.ray, hit);
      path.ray.t_max = met ? hit.t : infinite;
      std::optional<Collision> matter;
      if (media && !past_media) {
        const float u = sampler.next();
        RandomStream random(sampler.stream());
        matter = media->collide(path.ray, u, random);
        if (matter) path.ray.t_max = matter->t;
      }
      const Vec3f absorption = path.insides.absorption();
      if (!path.straight) {
        const Ray seen{path.turned_at, path.ray.direction, path.since + path.ray.t_max};
        out.radiance += path.throughput * world.lamps().seen(seen, path.since, path.pdf, absorption);
      } else if (!met && !matter) {
        out.passed = luminance(path.throughput);
      }
      if (!met && !matter) break;
      path.throughput = path.throughput * fade(absorption, path.ray.t_max);
      if (!(matter ? scatter(world, media, *matter, path, sampler, out) : meet(world, media, hit, path, sampler, out))) break;
    }
  }

  /// On from a surface; false where the path ends.
  bool meet(const World& world, MediaWalk* media, const Hit& hit, Path& path, Sampler& sampler, Estimate& out) const {
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
      out.radiance += path.throughput * v.emission * power_weight(path.pdf, p);
    }
    const Vec3f wo = v.frame.to_local(-path.ray.direction);
    const Lights& lights = mirrors_only_ ? world.lights() : world.lamps();
    if (path.bounces() < bounces_ && lights.asks()) {
      const float choice = sampler.next();
      const Vec2f u = sampler.next2();
      if (!v.bsdf.delta_only()) {
        const auto scattered = [&](Vec3f direction) -> Scattered {
          const Vec3f wi = v.frame.to_local(direction);
          if ((dot(direction, v.point.face_normal) > 0) != (wi.z > 0)) return {};
          return {v.bsdf.evaluate(wo, wi) * std::abs(wi.z), mirrors_only_ ? 0 : v.bsdf.pdf(wo, wi)};
        };
        const auto from = [&](Vec3f direction) { return Start{leave(v.point, direction), v.onward(path.insides, along, direction)}; };
        out.radiance += path.throughput * direct(world, lights, media, v.point.position, from, scattered, choice, u, sampler);
      }
    }

    // Into the body.
    if (const Vec3f enters = v.bsdf.entering(wo); !is_dark(enters) && path.bounces() < bounces_) {
      const float below = luminance(enters * v.bsdf.base_color()), chance = below / (below + luminance(v.bsdf.albedo(wo)));
      if (sampler.next() < chance) {
        RandomStream random(sampler.stream());
        const auto exit = walk_below(world, v, random);
        if (!exit) return false;
        path.throughput = path.throughput * enters * exit->weight / chance;
        return come_out(world, media, exit->at, path, sampler, out);
      }
      path.throughput = path.throughput / (1 - chance);
    }

    // On to the next surface.
    const float choice = sampler.next();
    const auto s = v.bsdf.sample(wo, choice, sampler.next2());
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
  bool come_out(const World& world, MediaWalk* media, const Vertex& v, Path& path, Sampler& sampler, Estimate& out) const {
    const auto scattered = [&](Vec3f direction) -> Scattered {
      const Vec3f wi = v.frame.to_local(direction);
      if (!(wi.z > 0) || !(dot(direction, v.point.face_normal) > 0)) return {};
      const float density = wi.z / std::numbers::pi_v<float>, share = v.bsdf.leaving(wi) * density;
      return {{share, share, share}, density};
    };
    const auto from = [&](Vec3f direction) { return Start{leave(v.point, direction), path.insides}; };
    if (world.lamps().asks()) {
      const float choice = sampler.next();
      const Vec2f u = sampler.next2();
      out.radiance += path.throughput * direct(world, world.lamps(), media, v.point.position, from, scattered, choice, u, sampler);
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
  bool scatter(const World& world, MediaWalk* media, const Collision& c, Path& path, Sampler& sampler, Estimate& out) const {
    out.radiance += path.throughput * c.emission;
    path.throughput = path.throughput * c.albedo;
    if (is_dark(path.throughput) || path.turns_in_media >= matter_turns * bounces_) return false;
    const bool last = c.last || mirrors_only_;
    const Vec3f along = path.ray.direction, from = c.start(path.ray.origin + along * c.t);
    const auto scattered = [&](Vec3f direction) -> Scattered {
      const float density = c.density(along, direction);
      return {{density, density, density}, last ? 0 : density};
    };
    const auto start = [&](Vec3f) { return Start{from, path.insides}; };
    if (const Lights& lights = last ? world.lights() : world.lamps(); lights.asks()) {
      const float choice = sampler.next();
      const Vec2f u = sampler.next2();
      out.radiance += path.throughput * direct(world, lights, media, from, start, scattered, choice, u, sampler);
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
  /// One of the lights, chosen by its power, if nothing is in the way. `from(direction)`: where rays to it start.
  template <class From, class F>
  Vec3f direct(const World& world, const Lights& lights, MediaWalk* media, Vec3f position, From&& from, F&& scattered, float choice,
               Vec2f u, Sampler& sampler) const {
    const uint64_t stream = media ? sampler.stream() : 0;
    const auto light = lights.sample(position, choice, u);
    if (!light) return {};
    const Scattered s = scattered(light->direction);
    if (is_dark(s.share)) return {};
    const Vec3f contribution = s.share * light->radiance * (1 / light->pdf);
    if (is_dark(contribution)) return {};
    // Up to the light's own surface, which is an item or is not.
    const Start start = from(light->direction);
    const Ray ray{start.origin, light->direction, light->distance * (1 - 1e-4f)};
    Vec3f passes = world.passes(ray, start.insides);
    if (is_dark(passes)) return {};
    if (media) {
      RandomStream random(stream);
      passes = passes * media->passes(ray, random);
    }
    const float weight = light->delta ? 1 : power_weight(light->pdf, s.pdf);
    return contribution * passes * weight;
  }

  int bounces_;
  bool mirrors_only_;
};

}  // namespace

std::unique_ptr<Integrator> path_integrator(int bounces) { return std::make_unique<PathIntegrator>(bounces, false); }
std::unique_ptr<Integrator> whitted_integrator(int bounces) { return std::make_unique<PathIntegrator>(bounces, true); }

}  // namespace sg::trace
