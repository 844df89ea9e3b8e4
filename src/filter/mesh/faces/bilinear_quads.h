// SPDX-License-Identifier: Apache-2.0
// Quadrilaterals as what they are, not as two triangles.
#pragma once
#include <string>

#include "data/dataset.h"

namespace sg {

/// A surface for drawing, coloured by the point field `field`: where quadrilaterals twist it (the values of their corners lie in no plane),
/// every triangle and quadrilateral becomes n x n parts of its linear or bilinear map, n up to 8, so that no crease of the colours runs
/// along a diagonal. All point fields are interpolated, integers as floats (colours keep their type); fields of cells are repeated. The
/// surface itself when nothing is twisted, or when its cells are too many to be seen one by one.
DatasetPtr bilinear_parts(const DatasetPtr& surface, const std::string& field);

}  // namespace sg
