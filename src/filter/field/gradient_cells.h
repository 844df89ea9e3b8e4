// SPDX-License-Identifier: Apache-2.0
// Gradients at the points of meshes that are lists of cells.
#pragma once
#include <cstdint>
#include <span>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Gradients by least squares over the points that share a cell with the given one, weights 1/distance^2: exact for linear
/// functions. `values` is packed f64, one tuple per point of the mesh; out receives 3 numbers per component per listed point. Where
/// all cells at a point are faces (or lines) the gradient along them is given. Points without neighbours, or with a NaN value, get
/// NaN; neighbours that are NaN are left out. Unstructured and surface meshes only.
void least_squares_gradients(const Dataset& dataset, std::span<const uint32_t> points, const Array& values, double* out,
                             const Context& context);

}  // namespace sg
