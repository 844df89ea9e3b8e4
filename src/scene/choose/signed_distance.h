// SPDX-License-Identifier: Apache-2.0
// Distances to a surface, negative on one side of it, by their slope.
#pragma once
#include "data/dataset.h"

namespace sg {

/// Whether a point field of a uniform grid of three dimensions is one: floats of both signs whose gradient has length 1 (within 10 %, at
/// nine of ten samples) in changing directions; where the field is held at its least or largest value (a narrow band) nothing is asked.
bool is_signed_distance(const Dataset& data, const Field& field);

}  // namespace sg
