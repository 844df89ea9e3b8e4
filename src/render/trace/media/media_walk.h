// SPDX-License-Identifier: Apache-2.0
// MediaWalk: one thread's way through all media of a scene.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/trace/media/participating_medium.h"
#include "render/trace/sampling/random_stream.h"

namespace sg::trace {

class MediaWalk {
 public:
  MediaWalk(std::span<const ParticipatingMedium> media, const Placement& placement);

  /// The first place up to ray.t_max at which light that comes along the ray would meet matter, drawn by tau exp(-integral of tau); nothing
  /// where it passes. u in [0, 1) decides in the first medium, `random` on the rest.
  std::optional<Collision> collide(const Ray& ray, float u, RandomStream& random);
  /// Whether optical depths are those of the field, not of steps.
  bool exact() const;
  /// The share of light that passes up to ray.t_max, without any chance; remembers the way for collide_surely().
  float passes_exactly(const Ray& ray);
  /// The same as collide() on the way of passes_exactly(), which must be below 1, on the condition that something is met. u in [0, 1).
  std::optional<Collision> collide_surely(float u, RandomStream& random);
  /// An estimate of the share of light that passes up to ray.t_max: its mean is exp(-integral of tau).
  float passes(const Ray& ray, RandomStream& random);

 private:
  struct Walker {
    const ParticipatingMedium* medium;
    std::unique_ptr<volume::RayField> cells;
    std::unique_ptr<volume::RaySpans> spans;  ///< may be null
    // The way of passes_exactly():
    volume::DepthRay ray;
    std::vector<volume::Stretch> stretches;
    std::vector<double> depth;  ///< at their ends
    double all() const { return depth.empty() ? 0 : depth.back(); }
  };
  /// A place in a medium.
  struct Place {
    double t;
    volume::Stretch stretch;  ///< around it, where it is known
    bool in_stretch;
    float value, tau;
  };
  // Each looks for the place at which the optical depth from `from` on reaches `left`, and takes off `left` what it passes.
  static bool in_cells(const Walker& w, const volume::DepthRay& ray, double from, double to, double& left, Place& place);
  static bool by_majorant(const Walker& w, const volume::Span& span, float majorant, double& left, RandomStream& random, Place& place);
  static bool in_cells_by_majorant(const Walker& w, const volume::DepthRay& ray, double& left, RandomStream& random, Place& place);
  static bool in_steps(const Walker& w, const volume::DepthRay& ray, double& left, Place& place);
  bool reaches(const Walker& w, const volume::DepthRay& ray, double left, RandomStream& random, Place& place);
  Collision collision_at(const Walker& w, const volume::DepthRay& ray, const Place& place, RandomStream& random) const;

  std::vector<Walker> walkers_;
  Placement placement_;
};

}  // namespace sg::trace
