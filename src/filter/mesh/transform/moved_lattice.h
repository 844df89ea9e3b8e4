// SPDX-License-Identifier: Apache-2.0
// Grids whose points go elsewhere.
#pragma once
#include <algorithm>

#include "base/parallel.h"
#include "data/lattice.h"

namespace sg {

/// The points of a lattice of any kind as a curvilinear grid, each at `place(point, position)`. Parallel.
template <class Place>
CurvilinearGrid moved_lattice(const Mesh& mesh, Place place) {
  constexpr size_t points_per_task = 1 << 14;
  const Lattice lattice(mesh);
  const LatticeView& v = lattice.view();
  const size_t nx = v.dims[0];
  CurvilinearGrid r;
  r.dims = v.dims;
  double* to = nullptr;
  r.points.xyz = Array::make<double>(v.points(), 3, &to);
  parallel_for(v.dims[1] * v.dims[2], std::max<size_t>(1, points_per_task / std::max<size_t>(nx, 1)), [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      for (size_t i = 0; i < nx; ++i) {
        const size_t point = row * nx + i;
        const Vec3 p = place(point, v.position(i, row % v.dims[1], row / v.dims[1]));
        for (int c = 0; c < 3; ++c) to[3 * point + size_t(c)] = p[c];
      }
  });
  return r;
}

}  // namespace sg
