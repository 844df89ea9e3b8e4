// SPDX-License-Identifier: Apache-2.0
// Derivatives of fields on meshes without an index space: from the points (or cells) around each point (or cell).
#pragma once
#include <cstdint>
#include <span>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// How many places did not get derivatives of full order; places whose own value is not a number are not counted.
struct FittedGaps {
  size_t places = 0;  ///< looked at
  size_t alone = 0;   ///< nothing around them has a value: NaN
  size_t slopes = 0;  ///< some first derivatives are not determined (all that is around lies in a line or plane): 0
  size_t bends = 0;   ///< first derivatives of first order only (exact for linear functions), some second ones 0
};

/// Gradients and Hessians at points, or (association cell) at the cells' centres, by QuadraticFit over the places that share a cell
/// (a point) of the same dimension; ring after ring is added where these are too few, or lie so that they do not determine a
/// parabola (borders of hexahedra: two layers). So gradients of smooth fields are of second order on smooth meshes up to their borders,
/// Hessians of first order (of second where neighbours lie on both sides alike), and both are exact for quadratic functions.
///
/// `values`: packed f64, one tuple per place of the mesh. `gradient`: 3 numbers per component, `hessian`: 6 (xx xy xz yy yz zz) or
/// null. On surfaces and lines derivatives are tangential. Neighbours without a finite value are left out; a place without one, or
/// without neighbours, has NaN derivatives.
FittedGaps fitted_derivatives(const DatasetPtr& dataset, Association on, const Array& values, double* gradient, double* hessian,
                              Context& context);
/// The same for some places, in their order.
FittedGaps fitted_derivatives_at(const DatasetPtr& dataset, Association on, std::span<const uint32_t> places, const Array& values,
                                 double* gradient, double* hessian, Context& context);

/// Reports once, as a warning, how many points have gaps; nothing when there are none.
void warn_of_gaps(const FittedGaps& gaps, Association on, const char* who, const Context& context);

}  // namespace sg
