// SPDX-License-Identifier: Apache-2.0
// The positions of all points of any mesh in one array.
#pragma once
#include "data/mesh.h"

namespace sg {

/// One tuple of 3 numbers per point, origin added: f64; the array itself, where the mesh lists f64 positions about 0. AMR: the points of
/// all patches.
Array point_positions(const Mesh& mesh);

}  // namespace sg
