// SPDX-License-Identifier: Apache-2.0
// advance() for the case that matters most: f32 velocities on a uniform grid along the axes that stays the same, Dormand-Prince. Several
// particles are under way at once, each a vector of its three components (in the plane: flat_advance.h). Internal to unsteady/.
#pragma once
#include <optional>

#include "filter/flow/unsteady/particles.h"

namespace sg::lattice_advance {

struct Job {
  const float* step[4] = {};     ///< velocities of the open steps (those missing of 2 or 4 repeat the last, with weight 0)
  int steps = 2;                 ///< 2 or 4
  int components = 3;            ///< of the velocities; 2 only where flat_advance takes the job
  size_t stride[3] = {0, 0, 0};  ///< floats from a point to the next along each axis; 0 along the axis without cells
  size_t last = 0;               ///< floats before the last cell, whose last point has nothing behind it
  double origin[3] = {0, 0, 0}, inverse[3] = {0, 0, 0}, cells[3] = {1, 1, 1};
  int flat = -1;                ///< the axis without cells
  double cell = 1;              ///< its size
  double begin = 0, scale = 1;  ///< s = (t - begin) * scale, 0 to 1 in the interval
  double weight[4][4] = {};     ///< of step j: ((w[j][3] s + w[j][2]) s + w[j][1]) s + w[j][0]
};

/// Null where the general way has to be taken.
std::optional<Job> job_of(const UnsteadyFlow& flow, const TraceOptions& options);

/// As advance() does, of particles whose numbers begin at `first`; adds to `way` unless null. The same bits on every processor.
void run(const Job& job, std::span<Particle> particles, size_t first, double until, int sign, const TraceOptions& options, Way* way);

}  // namespace sg::lattice_advance
