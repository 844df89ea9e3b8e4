// SPDX-License-Identifier: Apache-2.0
// Second derivatives across the borders of grids, where differences of differences lose an order.
#pragma once
#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Symmetric tensors of second derivatives (9 components) of `values` (one) at the points or cells of a lattice with straight axes at right
/// angles, or of each AMR patch, with the second derivatives along each axis of four or more samples recomputed in the two outer layers:
/// those of the cubic through the four outer places, of second order. Other lattices, and where one of these values is not finite: as
/// they were.
Array with_border_derivatives(const Dataset& grid, bool of_cells, const Array& values, const Array& tensors, Context& context);

/// The same at the two outer layers of a curvilinear grid, whose lines are bent: those of cubics through what lies around
/// (quadratic_fit.h). Where these have no value: as they were.
Array with_fitted_borders(const DatasetPtr& grid, const Field& field, const Array& tensors, Context& context);

}  // namespace sg
