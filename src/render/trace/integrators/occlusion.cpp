// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <limits>
#include <vector>

#include "render/trace/integrators/integrator.h"
#include "render/trace/sampling/cosine_strata.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

/// The rays from a point to the open, one in each stratum: samples of a pixel spread over the strata, and edges of pixels need fewer.
struct RaysToOpen {
  Vec3f from, directions[cosine_strata_count];
  uint32_t above;  ///< bit i of directions[i]; the others are those that a rounded normal has below the face

  RaysToOpen(const SurfacePoint& point, Vec3f seen_along, Vec2f in) {
    const bool below = dot(point.face_normal, seen_along) > 0;
    const Vec3f normal = below ? -point.shading_normal : point.shading_normal, out = below ? -point.face_normal : point.face_normal;
    above = cosine_strata(in, LocalFrame::about(normal), out, directions), from = leave(point, out);
  }
};

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
      const RaysToOpen to_open(point, ray.direction, sampler.next2());
      Ray rays[cosine_strata_count];
      int n = 0;
      for (uint32_t bits = to_open.above; bits; bits &= bits - 1)
        rays[n++] = {to_open.from, to_open.directions[std::countr_zero(bits)], reach_};
      const int open = n - std::popcount(world.geometry().blocked(rays, n));
      out.radiance += Vec3f(color.x, color.y, color.z) * (share * color.w * (float(open) / cosine_strata_count));
      share *= 1 - color.w;
      ray = {leave(point, ray.direction), ray.direction}, footprint = footprint.after(hit.t);
    }
    out.passed = share;
    return out;
  }

  // Where what is met is opaque: the rays of one stratum go about the same way through the tree.
  void along_all(const World& world, std::span<const CameraPath> paths, Sampler& sampler, Estimate* estimates) const override {
    if (world.has_media()) return Integrator::along_all(world, paths, sampler, estimates);
    Hit hits[most_paths];
    const uint64_t met = first_hits(world.geometry(), paths, hits);
    std::fill_n(estimates, paths.size(), Estimate{.passed = 1});
    if (met == 0) return;
    std::vector<RaysToOpen> to_open;
    to_open.reserve(paths.size());
    uint8_t path_of[most_paths];
    int open[most_paths] = {};
    for (uint64_t seen = met; seen; seen &= seen - 1) {
      const int i = std::countr_zero(seen);
      const CameraPath& path = paths[size_t(i)];
      const Vec4f color = world.color(path.ray, hits[i], path.footprint);
      if (color.w != 1) {
        estimates[i] = along(world, path, sampler), open[i] = cosine_strata_count;
        continue;
      }
      estimates[i] = {{color.x, color.y, color.z}, 0};
      sampler.start(path.x, path.y, path.sample, path.dimension);
      path_of[to_open.size()] = uint8_t(i);
      to_open.emplace_back(world.geometry().at(path.ray, hits[i]), path.ray.direction, sampler.next2());
      open[i] = std::popcount(to_open.back().above);
    }
    for (int k = 0; k < cosine_strata_count; ++k) {
      Ray rays[most_paths];
      uint8_t path[most_paths];
      int n = 0;
      for (size_t j = 0; j < to_open.size(); ++j)
        if (to_open[j].above >> k & 1) rays[n] = {to_open[j].from, to_open[j].directions[k], reach_}, path[n++] = path_of[j];
      for (uint64_t bits = world.geometry().blocked(rays, n); bits; bits &= bits - 1) --open[path[std::countr_zero(bits)]];
    }
    for (size_t i = 0; i < paths.size(); ++i) estimates[i].radiance *= float(open[i]) / cosine_strata_count;
  }

  uint32_t pass() const override { return 4; }  // each with many rays

 private:
  using Integrator::along;
  float reach_;
};

}  // namespace

std::unique_ptr<Integrator> occlusion_integrator(float reach) { return std::make_unique<OcclusionIntegrator>(reach); }

}  // namespace sg::trace
