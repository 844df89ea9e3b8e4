// SPDX-License-Identifier: Apache-2.0
// Derivatives of fields on meshes without an index space: from the points (or cells) around each point (or cell).
#pragma once
#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Gradients and Hessians at every point, or (association cell) at every cell's centre, by QuadraticFit over the places that share a cell
/// (a point), and a second ring where these are too few. `values`: packed f64. `gradient`: 3 numbers per component, `hessian`:
/// 6 (xx xy xz yy yz zz) or null. On surfaces and lines derivatives are tangential. NaN neighbours are left out; a NaN place, and one
/// without neighbours, has NaN derivatives.
void fitted_derivatives(const DatasetPtr& dataset, Association on, const Array& values, double* gradient, double* hessian,
                        Context& context);

}  // namespace sg
