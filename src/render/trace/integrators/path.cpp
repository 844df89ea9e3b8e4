// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "render/trace/integrators/integrator.h"
#include "render/trace/light/luminance.h"
#include "render/trace/sampling/mis.h"

namespace sg::trace {

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

bool is_dark(Vec3f c) { return !(c.x > 0 || c.y > 0 || c.z > 0); }

class PathIntegrator : public Integrator {
 public:
  explicit PathIntegrator(int bounces, bool mirrors_only) : bounces_(bounces), mirrors_only_(mirrors_only) {}

  Estimate along(const World& world, const Ray& first, Sampler& sampler) const override {
    Estimate out;
    Ray ray = first;
    Vec3f throughput{1, 1, 1}, absorption;  // of the matter around the path
    float pdf = infinite;                   // of the last turn; of deltas and the camera infinite: lights are met by chance alone
    bool straight = true;                   // from the camera on, through what is translucent
    Vec3f turned_at = first.origin;         // where the direction was drawn
    float since = 0;                        // and how far the path has come
    for (int turns = 0;;) {
      Hit hit;
      const bool met = world.geometry().nearest(ray, hit);
      ray.t_max = met ? hit.t : infinite;
      if (!straight) {
        out.radiance += throughput * world.lights().seen({turned_at, ray.direction, since + ray.t_max}, since, pdf);
      } else if (!met) {
        out.passed = luminance(throughput);
      }
      if (!met) break;
      if (!is_dark(absorption))
        for (int c = 0; c < 3; ++c) throughput[c] *= std::exp(-absorption[c] * hit.t);

      const Vertex v = world.at(ray, hit);
      if (!is_dark(v.emission)) {
        const float p = world.lights().triangle_pdf(hit.object, hit.primitive, since + hit.t, dot(ray.direction, v.point.face_normal));
        out.radiance += throughput * v.emission * power_weight(pdf, p);
      }
      const Vec3f wo = v.frame.to_local(-ray.direction);
      if (turns < bounces_) out.radiance += throughput * direct(world, v, wo, sampler);

      // On to the next surface.
      const float choice = sampler.next();
      const auto s = v.bsdf.sample(wo, choice, sampler.next2());
      const float roulette = sampler.next();
      if (!s || is_dark(s->weight) || (mirrors_only_ && !s->delta)) break;
      const bool passes = s->delta && s->transmitted && s->eta == 1 && dot(s->direction, wo) < -0.9999f;
      if (!passes && turns >= bounces_) break;  // what is translucent is seen through all the same
      const Vec3f direction = normalize(v.frame.to_world(s->direction));
      // What the shading normal calls one side and the surface the other is no way for light.
      if ((dot(direction, v.point.face_normal) > 0) != (s->direction.z > 0)) break;
      throughput = throughput * s->weight;
      const Vec3f from = leave(v.point, direction);
      if (passes) since += hit.t;
      else ++turns, straight = false, pdf = s->delta ? infinite : s->pdf, turned_at = from, since = 0;
      if (s->transmitted && v.material->has_inside() && !passes) absorption = s->direction.z < 0 ? v.material->absorption() : Vec3f();
      if (turns > 3) {
        const float stay = std::min(0.95f, std::max({throughput.x, throughput.y, throughput.z}));
        if (roulette >= stay) break;
        throughput = throughput / stay;
      }
      ray = {from, direction, infinite};
    }
    return out;
  }

 private:
  // One light, chosen by its power, if nothing is in the way.
  Vec3f direct(const World& world, const Vertex& v, Vec3f wo, Sampler& sampler) const {
    const float choice = sampler.next();
    const Vec2f u = sampler.next2();
    if (v.bsdf.delta_only()) return {};
    const auto light = world.lights().sample(v.point.position, choice, u);
    if (!light) return {};
    const Vec3f wi = v.frame.to_local(light->direction), f = v.bsdf.evaluate(wo, wi);
    if ((dot(light->direction, v.point.face_normal) > 0) != (wi.z > 0)) return {};
    if (is_dark(f)) return {};
    const Vec3f contribution = f * light->radiance * (std::abs(wi.z) / light->pdf);
    if (is_dark(contribution)) return {};
    const Vec3f from = leave(v.point, light->direction);
    // Up to the light's own surface, which is an item or is not.
    const Vec3f passes = world.passes({from, light->direction, light->distance * (1 - 1e-4f)});
    if (is_dark(passes)) return {};
    const float weight = light->delta || mirrors_only_ ? 1 : power_weight(light->pdf, v.bsdf.pdf(wo, wi));
    return contribution * passes * weight;
  }

  int bounces_;
  bool mirrors_only_;
};

}  // namespace

std::unique_ptr<Integrator> path_integrator(int bounces) { return std::make_unique<PathIntegrator>(bounces, false); }
std::unique_ptr<Integrator> whitted_integrator(int bounces) { return std::make_unique<PathIntegrator>(bounces, true); }

}  // namespace sg::trace
