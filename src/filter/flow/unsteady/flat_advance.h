// SPDX-License-Identifier: Apache-2.0
// advance() in the plane: f32 velocities on a uniform grid along the axes with two axes of cells, Dormand-Prince. Particles lie side by
// side in the lanes of vectors, each with its own step size. Internal to unsteady/.
#pragma once
#include "filter/flow/unsteady/lattice_advance.h"

namespace sg::flat_advance {

/// Whether it is a plane whose two components are adjacent in memory (all except the xz plane).
bool takes(const lattice_advance::Job& job);

/// As lattice_advance::run(). The same bits for any width of vectors (x86: from SSSE3 on;
/// a processor without vectors goes the way of lattice_advance).
void run(const lattice_advance::Job& job, std::span<Particle> particles, size_t first, double until, int sign, const TraceOptions& options,
         Way* way);

}  // namespace sg::flat_advance
