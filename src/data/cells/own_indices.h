// SPDX-License-Identifier: Apache-2.0
// Numbers that kernels use as places in memory must stay what they were when they were checked.
#pragma once
#include "data/mesh.h"

namespace sg {

/// Copies lists of ids, offsets, types and orders of cells, and coordinates that are searched, where they lie in a mapped file: another
/// program may write over them after validate(). Points and fields stay where they are: any number in them is a number.
void own_indices(Mesh& mesh);

}  // namespace sg
