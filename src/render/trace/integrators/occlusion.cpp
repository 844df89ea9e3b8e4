// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <limits>

#include "render/trace/integrators/integrator.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

/// Rays to the open for each from the camera, in as many strata of the hemisphere along each axis: edges of pixels need fewer.
constexpr int strata = 4;

class OcclusionIntegrator : public Integrator {
 public:
  explicit OcclusionIntegrator(float reach) : reach_(reach) {}

  Estimate along(const World& world, const Ray& first, Sampler& sampler, const RayFootprint& whole) const override {
    const Media::Borrowed media = world.borrow_media();
    Estimate out;
    float share = 1;  // that has not met anything
    Ray ray = first;
    RayFootprint footprint = whole;
    for (Hit hit; share > 0; hit = Hit()) {
      const bool met = world.geometry().nearest(ray, hit);
      if (media) {
        ray.t_max = met ? hit.t : std::numeric_limits<float>::infinity();
        const float u = sampler.next();
        RandomStream random(sampler.stream());
        if (const auto matter = media->collide(ray, u, random)) {
          const Vec3f from = matter->start(ray.origin + ray.direction * matter->t);
          const Vec2f v = sampler.next2();
          const Vec3f direction = matter->on_surface ? LocalFrame::about(matter->normal).to_world(cosine_hemisphere(v)) : uniform_sphere(v);
          const Ray open{from, normalize(direction), reach_};
          const float passes = world.geometry().blocked(open) ? 0 : media->passes(open, random);
          out.radiance += (matter->albedo * passes + matter->emission) * share;
          share = 0;
          break;
        }
      }
      if (!met) break;
      const SurfacePoint point = world.geometry().at(ray, hit);
      const Vec4f color = world.color(ray, hit, footprint);
      const bool below = dot(point.face_normal, ray.direction) > 0;
      const Vec3f normal = below ? -point.shading_normal : point.shading_normal;
      const LocalFrame frame = LocalFrame::about(normal);
      const float side = below ? -1.f : 1.f;
      // At the same place in each stratum: systematic sampling, whose places samples of a pixel spread over the stratum.
      const Vec2f in = sampler.next2();
      int open = 0;
      for (int row = 0; row < strata; row += strata / 2) {
        Ray rays[strata * strata / 2];
        int above = 0;
        for (int i = row * strata; i < row * strata + strata * strata / 2; ++i) {
          const Vec2f u{(float(i % strata) + in.x) / strata, (float(i / strata) + in.y) / strata};
          const Vec3f direction = normalize(frame.to_world(cosine_hemisphere(u)));
          // Directions below the face are those that the rounded normal would have, not the surface.
          if (dot(direction, point.face_normal) * side > 0) rays[above++] = {leave(point, direction), direction, reach_};
        }
        open += above - std::popcount(world.geometry().blocked(rays, above));
      }
      out.radiance += Vec3f(color.x, color.y, color.z) * (share * color.w * float(open) / (strata * strata));
      share *= 1 - color.w;
      ray = {leave(point, ray.direction), ray.direction}, footprint = footprint.after(hit.t);
    }
    out.passed = share;
    return out;
  }
  uint32_t pass() const override { return 4; }  // each with many rays

 private:
  float reach_;
};

}  // namespace

std::unique_ptr<Integrator> occlusion_integrator(float reach) { return std::make_unique<OcclusionIntegrator>(reach); }

}  // namespace sg::trace
