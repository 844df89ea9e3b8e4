// SPDX-License-Identifier: Apache-2.0
// Integrators that light the picture as a whole, as their paths may end in any pixel.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "base/context.h"
#include "render/trace/integrators/bidirectional/splat_film.h"
#include "render/trace/integrators/bidirectional/subpath.h"
#include "render/trace/light_options.h"

namespace sg::trace {

/// What one pass adds: sums over its paths. A pixel's own light and passage are written by the thread that has the pixel.
struct PassFilm {
  PassFilm(int width, int height) : splats(width, height), own(size_t(width) * size_t(height)), passed(size_t(width) * size_t(height)) {}

  SplatFilm splats;
  std::vector<Vec3> own;
  std::vector<float> passed;  ///< to the background, straight on
};

class PictureIntegrator {
 public:
  virtual ~PictureIntegrator() = default;
  /// So many paths a pixel are made between two looks at the error.
  virtual int pass_size() const = 0;
  /// The samples [from, to) of each pixel, into a cleared film.
  virtual void pass(uint32_t from, uint32_t to, PassFilm& film, Context& context) = 0;
  /// By which splats are to be multiplied, as far as is known by now, and its relative standard error.
  virtual double factor() const { return 1; }
  virtual double factor_error() const { return 0; }
};

/// Paths from the lights, each turn of which is seen by the camera (Arvo 1986; Dutre, Lafortune, Willems 1993). What the camera sees by
/// mirrors or through glass is not found.
std::unique_ptr<PictureIntegrator> light_integrator(const PathScene& scene, const LightOptions& options);
/// Paths from both ends, joined in every way (Veach, Guibas 1994; Lafortune, Willems 1993), weighed by the power heuristic.
std::unique_ptr<PictureIntegrator> bidirectional_integrator(const PathScene& scene, const LightOptions& options);
/// Markov chains in the space of the numbers that bidirectional paths are made of (Kelemen et al. 2002), each for paths of one number of
/// turns, in which the way to make the path is one of the numbers (Hachisuka, Kaplanyan, Dachsbacher 2014).
std::unique_ptr<PictureIntegrator> metropolis_integrator(const PathScene& scene, const LightOptions& options);

}  // namespace sg::trace
