// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/subsurface_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/shade/phase.h"
#include "render/shade/scatter_albedo.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

constexpr int most_steps = 10000;
/// Of traced lengths about 1: shorter paths are drowned by the rounding of places.
constexpr float shortest_path = 1e-4f;

Vec2f two(RandomStream& random) {
  const float x = random.next();
  return {x, random.next()};
}

/// Which of red, green and blue, in proportion to their weights.
int channel_of(Vec3f weight, float u) {
  u *= weight.x + weight.y + weight.z;
  return u < weight.x ? 0 : u < weight.x + weight.y || !(weight.z > 0) ? 1 : 2;
}

Vec3f turned(Vec3f along, float g, RandomStream& random) {
  const float cosine = sample_henyey_greenstein(g, random.next()), sine = std::sqrt(std::max(0.f, 1 - cosine * cosine));
  const float turn = 2 * std::numbers::pi_v<float> * random.next();
  return normalize(LocalFrame::about(along).to_world({sine * std::cos(turn), sine * std::sin(turn), cosine}));
}

}  // namespace

std::optional<WalkExit> walk_below(const World& world, const Vertex& entry, RandomStream& random) {
  const float g = entry.below_anisotropy;
  const Vec3f albedo = single_scatter_albedo(entry.bsdf.base_color(), g);
  Vec3f extinction;
  for (int c = 0; c < 3; ++c) extinction[c] = 1 / std::max(entry.below_radius[c], shortest_path);

  Vec3f weight{1, 1, 1};
  Vec3f direction = normalize(LocalFrame::about(-entry.point.face_normal).to_world(cosine_hemisphere(two(random))));
  Ray ray{leave(entry.point, direction), direction};
  for (int step = 0; step < most_steps; ++step) {
    Hit hit;
    const bool met = world.geometry().nearest(ray, hit);
    const double drawn = random.exponential() / double(extinction[channel_of(weight, random.next())]);
    const bool passes = met && drawn >= double(hit.t);
    const float t = passes ? hit.t : float(drawn);
    const float all = weight.x + weight.y + weight.z;
    Vec3f density;
    float mean = 0;
    for (int c = 0; c < 3; ++c) {
      density[c] = std::exp(-extinction[c] * t) * (passes ? 1 : extinction[c]);
      mean += density[c] * weight[c] / all;
    }
    if (!(mean > 0)) return {};
    weight = weight * density * (1 / mean);

    if (passes) {
      const Vertex v = world.at(ray, hit);
      const float across = dot(ray.direction, v.point.face_normal);
      const bool own = world.same_surface(entry.point, hit);
      if (own && across > 0) return WalkExit{v, weight};
      direction = ray.direction;
      if (!own) {
        const float choice = random.next();
        const auto s = v.bsdf.sample(v.frame.to_local(-ray.direction), choice, two(random));
        if (!s) return {};
        direction = normalize(v.frame.to_world(s->direction));
        if ((dot(direction, v.point.face_normal) > 0) != (s->direction.z > 0)) return {};
        weight = weight * s->weight;
      }
      ray = {leave(v.point, direction), direction};
    } else {
      weight = weight * albedo;
      ray = {ray.origin + ray.direction * t, turned(ray.direction, g, random)};
    }
    const float stay = std::min(1.f, std::max({weight.x, weight.y, weight.z}));
    if (!(random.next() < stay)) return {};
    weight = weight / stay;
  }
  return {};
}

}  // namespace sg::trace
