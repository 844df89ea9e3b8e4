// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/blanking.h"

#include <algorithm>

#include "base/parallel.h"
#include "data/dataset.h"

namespace sg {

size_t lattice_cell_count(const std::array<size_t, 3>& dims) {
  size_t n = 1;
  for (const size_t d : dims) n *= std::max<size_t>(d - 1, 1);
  return n;
}

void hide_cells(const std::array<size_t, 3>& n, const uint8_t* points, uint8_t* cells) {
  const std::array<size_t, 3> c{std::max<size_t>(n[0] - 1, 1), std::max<size_t>(n[1] - 1, 1), std::max<size_t>(n[2] - 1, 1)};
  parallel_for(c[1] * c[2], 64, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t j = row % c[1], k = row / c[1];
      for (size_t i = 0; i < c[0]; ++i) {
        uint8_t hidden = 0;
        for (size_t corner = 0; corner < 8; ++corner) {
          const size_t x = i + (corner & 1), y = j + (corner >> 1 & 1), z = k + (corner >> 2);
          if (x < n[0] && y < n[1] && z < n[2]) hidden |= points[x + n[0] * (y + n[1] * z)];
        }
        if (hidden) cells[row * c[0] + i] |= uint8_t(ghost_hidden_cell);
      }
    }
  });
}

}  // namespace sg
