// SPDX-License-Identifier: Apache-2.0
// What a picture leaves out so that it comes at once.
#pragma once
#include "scene/scene.h"
#include "serve/renderer/renderer.h"

namespace sg::serve {

/// The scene as it is drawn where less than the exact picture will do: volumes by fixed steps of a voxel (moving) or half of one (draft),
/// where they have voxels, else within a wider tolerance. `coarse`: of a moving picture; beyond most_pixels_a_sample steps are longer.
Scene rough(Scene scene, Quality quality, double coarse = 1);

/// How many pixels of a view one sample stands for, along each side, in the next picture while it moves, so that it takes `budget` seconds:
/// 1, 1.5, 2, 3, 4, 6 or 8, a step from `coarse`, whose picture took `seconds`. 12 and 16 stand for 8 pixels and steps of 1.5 and 2 voxels.
double next_coarseness(double coarse, double seconds, double budget);
inline constexpr double most_pixels_a_sample = 8;
inline constexpr double first_coarseness = 8;  ///< where nothing was drawn yet: a first picture comes at once

}  // namespace sg::serve
