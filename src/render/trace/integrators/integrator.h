// SPDX-License-Identifier: Apache-2.0
// Integrators: how much light comes along a ray.
#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "render/trace/integrators/world.h"
#include "render/trace/sampling/sampler.h"

namespace sg::trace {

/// An estimate of what is seen along a ray.
struct Estimate {
  Vec3f radiance;
  float passed = 0;  ///< share that went straight on to the background, which is not in the radiance
};

/// Most turns of a path in media for each one at a surface that it may make: matter turns light much more often.
constexpr int matter_turns = 128;

/// A ray of the camera, and which of the sampler's numbers follow.
struct CameraPath {
  Ray ray;
  RayFootprint footprint;
  uint32_t x = 0, y = 0, sample = 0, dimension = 0;  ///< as of Sampler::start()
};

/// The most paths that are followed together: one for each pixel of a square of 8 x 8.
constexpr int most_paths = Geometry::most_together;

/// What the paths meet first: bit i where hits[i] was found.
inline uint64_t first_hits(const Geometry& geometry, std::span<const CameraPath> paths, Hit* hits) {
  Ray rays[most_paths];
  for (size_t i = 0; i < paths.size(); ++i) rays[i] = paths[i].ray;
  return geometry.nearest(rays, int(paths.size()), hits);
}

class Integrator {
 public:
  virtual ~Integrator() = default;
  /// Unbiased but for what each kind states. `ray` starts outside of everything.
  virtual Estimate along(const World& world, const Ray& ray, Sampler& sampler, const RayFootprint& footprint = {}) const = 0;
  /// The same of up to most_paths through neighbouring pixels, `estimates` as many: to the same bytes as one by one.
  virtual void along_all(const World& world, std::span<const CameraPath> paths, Sampler& sampler, Estimate* estimates) const {
    for (size_t i = 0; i < paths.size(); ++i) estimates[i] = along(world, paths[i], sampler);
  }
  /// One of them.
  Estimate along(const World& world, const CameraPath& path, Sampler& sampler) const {
    sampler.start(path.x, path.y, path.sample, path.dimension);
    return along(world, path.ray, sampler, path.footprint);
  }
  /// Paths a pixel between two looks at its error.
  virtual uint32_t pass() const { return 16; }
};

/// Paths from the camera that turn at surfaces, at most `bounces` times, and in media, at most matter_turns times as often. At each turn
/// one light is asked for directly (next-event estimation), and weighed against meeting it by chance (Veach 1997); paths that carry little
/// are ended at random (Russian roulette).
std::unique_ptr<Integrator> path_integrator(int bounces);
/// The same where only mirrors and clear glass send paths on.
std::unique_ptr<Integrator> whitted_integrator(int bounces);
/// The share of light from everywhere that is not stopped within `reach`, traced coordinates, in the colours of the surfaces.
std::unique_ptr<Integrator> occlusion_integrator(float reach);

}  // namespace sg::trace
