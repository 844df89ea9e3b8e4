// SPDX-License-Identifier: Apache-2.0
// The velocity at the places of a lattice themselves: means of the faces about them.
#pragma once
#include "simulate/fluid/mac_grid.h"

namespace sg::fluid {

/// The three components at the places of row `row` of the lattice of `axis` (-1: the middles of cells), in `out[component][i]`: what linear
/// interpolation gives there. Beyond the border the nearest faces count.
template <class T>
void place_velocities(const MacGrid& g, const Faces<T>& u, int axis, size_t row, T* const out[3]);

}  // namespace sg::fluid
