// SPDX-License-Identifier: Apache-2.0
// Gradients of a scalar along rows of an axis-parallel grid, at memory speed.
#pragma once
#include <vector>

#include "filter/field/derivatives/lattice_frame.h"

namespace sg {

/// Axis-parallel grids with even steps in a row: x, y, z of the frame are those of space.
bool has_fast_rows(const LatticeFrame& frame);

/// Row r = j + ny*k: the same stencils as the general path, in the numbers' own type. False when a value of the row or next to it is
/// missing or infinite: then `out` is invalid and the general path must do the row. `scratch` is kept between calls.
bool fast_row_gradient(const LatticeFrame& frame, const float* f, float* out, size_t r, std::vector<float>& scratch);
bool fast_row_gradient(const LatticeFrame& frame, const double* f, double* out, size_t r, std::vector<double>& scratch);

}  // namespace sg
