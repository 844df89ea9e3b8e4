// SPDX-License-Identifier: Apache-2.0
// A part of a lattice: an index box, every n-th point.
#pragma once
#include "data/dataset.h"

namespace sg {

/// Points lo..hi (inclusive; hi is clamped) of a lattice, every stride-th along each axis; hi itself is kept only when the stride
/// meets it. Cell fields take the cell at each kept point, and only where stride is 1 along all axes of more than one cell (else
/// they are dropped, with a note). extent_start moves along, so that parts know their place. Throws Error(usage) for an empty box,
/// a stride of 0 or a mesh that is not a lattice.
DatasetPtr crop_lattice(const Dataset& dataset, std::array<size_t, 3> lo, std::array<size_t, 3> hi,
                        std::array<size_t, 3> stride = {1, 1, 1});

/// The numbers at those places of an nx*ny*nz block, packed.
Array crop_block(const Array& values, std::array<size_t, 3> dims, std::array<size_t, 3> lo, std::array<size_t, 3> count,
                 std::array<size_t, 3> stride);

}  // namespace sg
