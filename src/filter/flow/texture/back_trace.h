// SPDX-License-Identifier: Apache-2.0
// Where the pixels of a frame come from: paths back through the flow, several side by side.
#pragma once
#include "filter/flow/texture/pixel_flow.h"

namespace sg::texture {

struct BackTrace {
  double h = 0;  ///< of a step, in units of time; negative: back
  int64_t steps = 0;
  std::vector<Vec3> dye;        ///< in pixels
  double pitch[3] = {1, 1, 1};  ///< world lengths of a pixel: distances to dye are measured in the world
};

struct BackPath {
  double x[3] = {0, 0, 0};    ///< where it begins, inside the grid
  double nearest = HUGE_VAL;  ///< square of the least distance to a place of dye
  bool left = false;          ///< the grid, where x lies on its border
};

/// `steps` steps of the method of Runge and Kutta of order 4 from each place. A path stops where it leaves the grid, where it does not move
/// and where the velocity has no value.
void trace_back(const PixelFlow& flow, const BackTrace& how, BackPath* paths, size_t count);
/// The same, path by path: the reference.
void trace_back_scalar(const PixelFlow& flow, const BackTrace& how, BackPath* paths, size_t count);

}  // namespace sg::texture
