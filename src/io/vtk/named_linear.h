// SPDX-License-Identifier: Apache-2.0
// Quadratic cells that a file names by the linear cell of their shape.
#pragma once
#include "data/dataset.h"

namespace sg::vtk {

/// Gives cells that have the number of points of a quadratic cell, and the type of the linear one, the type of the quadratic one
/// ("hexahedra" of 20 points, as other readers take them too). How many.
size_t mend_named_linear(UnstructuredMesh& mesh);

}  // namespace sg::vtk
