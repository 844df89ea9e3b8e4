// SPDX-License-Identifier: Apache-2.0
// Line integral convolution of noise on a surface, whatever directions its lines follow.
#pragma once
#include <span>

#include "base/context.h"
#include "filter/flow/texture/line_fade.h"
#include "filter/flow/texture/surface/surface_walk.h"

namespace sg {

/// What the operations surface_lic and tensor_lic have in common; 64 million triangles are the most.
struct SurfaceConvolution {
  int steps = 40;
  double step = 0;  ///< 0: half the mean edge
  LineFade kernel = LineFade::hann;
  bool stretch = true;
  int64_t seed = 1;
};
inline double step_length(const RefinedSurface& surface, double step) { return step > 0 ? step : 0.5 * surface.edge_length; }
/// Lines of textures are straight for no more than two steps.
inline double longest_piece(const RefinedSurface& surface, double step) { return 2 * step_length(surface, step); }
constexpr size_t most_textured_triangles = size_t(64) << 20;

/// For each point the mean of the noise along its line, f32. `reach`: for each point the part of the steps that its line has; where that is
/// 0 or there is no direction the point keeps its own noise, and NaN means 0.5. Empty: lines are whole, 0.5 where there is no direction.
/// `Walk`: SurfaceWalk or SurfaceAxisWalk.
template <class Walk>
Array convolve_surface(const RefinedSurface& surface, const Walk& walk, const SurfaceConvolution& params, std::span<const float> reach,
                       const Context& context);

/// Gives points that lie at one place the value of the first.
void share_same_places(const RefinedSurface& surface, float* values);

/// The surface with the fields `made` before its own, which they replace where they have the same name.
DatasetPtr textured_surface(const RefinedSurface& surface, std::vector<Field> made);

}  // namespace sg
