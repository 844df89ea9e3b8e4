// SPDX-License-Identifier: Apache-2.0
#include "index/minmax_bricks.h"

#include "base/parallel.h"
#include "index/brick_row.h"

namespace sg {

MinMaxBricks minmax_bricks(const Array& values, std::array<size_t, 3> dims) {
  const size_t n = dims[0] * dims[1] * dims[2];
  if (values.components() != 1 || !values.packed() || values.count() != n || n == 0)
    fail_internal("minmax_bricks: the array does not fit the lattice");
  MinMaxBricks r;
  for (size_t a = 0; a < 3; ++a) r.dims[a] = (std::max<size_t>(dims[a], 2) - 2) / MinMaxBricks::edge + 1;
  r.ranges.resize(r.dims[0] * r.dims[1] * r.dims[2]);
  dispatch(values, [&](auto view) {
    using T = std::remove_cvref_t<decltype(view.data[0])>;
    parallel_for(r.dims[1] * r.dims[2], 4, [&](size_t begin, size_t end) {
      std::vector<T> lo, hi;
      for (size_t row = begin; row < end; ++row)
        brick_row(view.data, dims, (row % r.dims[1]) * MinMaxBricks::edge, (row / r.dims[1]) * MinMaxBricks::edge, lo, hi,
                  MinMaxBricks::edge, &r.ranges[row * r.dims[0]], r.dims[0]);
    });
  });
  return r;
}

// One sweep forth and one back over the 26 neighbours, each at distance one: exact for the Chebyshev distance.
std::vector<uint8_t> empty_distance(const std::vector<uint8_t>& empty, std::array<size_t, 3> dims) {
  const size_t n = dims[0] * dims[1] * dims[2];
  if (empty.size() != n) fail_internal("empty_distance: expected one flag per cube");
  std::vector<uint8_t> d(n);
  for (size_t i = 0; i < n; ++i) d[i] = empty[i] ? 255 : 0;
  const ptrdiff_t nx = ptrdiff_t(dims[0]), ny = ptrdiff_t(dims[1]), nz = ptrdiff_t(dims[2]);
  auto relax = [&](ptrdiff_t i, ptrdiff_t j, ptrdiff_t k, int sign) {
    uint8_t& here = d[size_t(i + nx * (j + ny * k))];
    int best = here;
    for (int m = 0; m < 13; ++m) {  // the 13 neighbours that come before this cube in the order of the sweep
      const int dx = m % 3 - 1, dy = m / 3 % 3 - 1, dz = m / 9 - 1;
      const ptrdiff_t x = i + sign * dx, y = j + sign * dy, z = k + sign * dz;
      if (x < 0 || y < 0 || z < 0 || x >= nx || y >= ny || z >= nz) continue;
      best = std::min(best, d[size_t(x + nx * (y + ny * z))] + 1);
    }
    here = uint8_t(best);
  };
  for (ptrdiff_t k = 0; k < nz; ++k)
    for (ptrdiff_t j = 0; j < ny; ++j)
      for (ptrdiff_t i = 0; i < nx; ++i) relax(i, j, k, 1);
  for (ptrdiff_t k = nz; k-- > 0;)
    for (ptrdiff_t j = ny; j-- > 0;)
      for (ptrdiff_t i = nx; i-- > 0;) relax(i, j, k, -1);
  return d;
}

}  // namespace sg
