// SPDX-License-Identifier: Apache-2.0
// A curved cell's reference element in linear parts. Inside filter/mesh only.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "data/cells/cell_type.h"

namespace sg::detail {

/// The parts of a reference element, its edges halved `level` times: hexahedra 8 per halving, pyramids 6 pyramids and 4 tetrahedra.
struct CellPattern {
  struct Part {
    CellType type;
    uint32_t begin;  ///< its corners in `corners`, in the order of its type
    uint32_t count;
  };
  /// A corner of the element and how much of a point it makes up, relative to the others: equal for all cells that share the point.
  struct Share {
    uint8_t corner;
    int64_t weight;
  };
  std::vector<Part> parts;
  std::vector<uint32_t> corners;               ///< places in `points`
  std::vector<Vec3> points, middles;           ///< reference coordinates, each once
  std::vector<std::array<uint32_t, 3>> spans;  ///< two corners of a part (each pair once), and the place in `middles` between them
  std::vector<Share> shares;                   ///< of the points, one after the other
  std::vector<uint32_t> shares_begin;          ///< points + 1
  std::span<const Share> shares_of(size_t point) const {
    return std::span(shares).subspan(shares_begin[point], shares_begin[point + 1] - shares_begin[point]);
  }
};

/// `base`: line, triangle, quad, tetra, wedge, pyramid or hexahedron.
CellPattern cell_pattern(CellType base, int level);
/// How many parts that are.
double part_count(CellType base, int level);

}  // namespace sg::detail
