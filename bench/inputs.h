// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "data/dataset.h"

namespace sg::bench {

/// f = sin(2 pi x) cos(2 pi y) + sin(2 pi y) cos(2 pi z) + sin(2 pi z) cos(2 pi x) + x^2 + y^2 + z^2 - 0.8 on [-1,1]^3, n^3 f32.
DatasetPtr field_grid(size_t n);
/// Its surface 0, with normals: n = 235, 526, 744 give 1, 5 and 10 million triangles.
DatasetPtr surface_mesh(size_t n);
/// 6 n^3 tetrahedra of a smoothly displaced cube: n = 55 gives a million.
DatasetPtr tetrahedra(size_t n);
/// The same cube as n^3 hexahedra.
DatasetPtr hexahedra(size_t n);

}  // namespace sg::bench
