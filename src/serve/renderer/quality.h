// SPDX-License-Identifier: Apache-2.0
// What a picture leaves out so that it comes at once.
#pragma once
#include "scene/scene.h"
#include "serve/renderer/renderer.h"

namespace sg::serve {

/// The scene as it is drawn where less than the exact picture will do: volumes by fixed steps of a voxel (moving) or half of one (draft),
/// where they have voxels, else within a wider tolerance.
Scene rough(Scene scene, Quality quality);

/// How many pixels of a view one sample stands for, along each side, in the next picture while it moves, so that it takes `budget` seconds:
/// 1, 1.5, 2, 3, 4, 6 or 8, a step from `coarse`, whose picture took `seconds`.
double next_coarseness(double coarse, double seconds, double budget);
inline constexpr double first_coarseness = 4;

}  // namespace sg::serve
