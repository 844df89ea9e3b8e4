// SPDX-License-Identifier: Apache-2.0
// Rough data in light: fixed steps, whose error is measured, in place of a tolerance that takes very long to be kept.
#pragma once
#include <string>

#include "base/context.h"
#include "scene/scene.h"

namespace sg {

/// What a small picture of the volume told.
struct MeasuredSteps {
  double step = 0;                ///< world length; 0 = no step is near enough, the tolerance is kept
  int parts = 0;                  ///< of the shortest distance of two samples, that a step is one of
  double turns = 0;               ///< how often a ray of it within the tolerance goes on, on average
  size_t rays = 0;                ///< that met something
  double usual = 0, largest = 0;  /// errors in linear light, shares of full scale: of 99 in 100 rays, and of all

  std::string text() const;
};

/// Whether the only volume of a scene is a uniform grid without a stated tolerance or step, lit and composited along rays, and all of it
/// is here (Context::communicator).
bool steps_may_be_measured(const Scene& scene, const Context& context);
/// Of such a scene: whether rays go on so often, as through noise, that steps of 1/2, 1/4 or 1/8 of the distance of samples are better;
/// the longest for which 99 rays in 100 are within eight times the usual tolerance. Empty for all others. Depends on the volume and the
/// lights alone, not on camera and size, so that all pictures of a scene are drawn alike. Shadows and occlusion are left out. O(6400 rays).
std::optional<MeasuredSteps> measure_steps(const Scene& scene, Context& context);

/// The scene as it is drawn then.
Scene in_steps(Scene scene, const MeasuredSteps& measured);

}  // namespace sg
