// SPDX-License-Identifier: Apache-2.0
// Corners, edges and faces of MFEM's elements as its documentation lists them, written down independently of the reader.
#pragma once
#include <set>
#include <vector>

#include "base/vec.h"
#include "io/mfem/element.h"

namespace sg::test::mfem_lists {

using sg::mfem::Geometry;
using Places = std::vector<Vec3>;  // of reference coordinates

struct Element {
  Geometry shape;
  std::vector<int64_t> corners;
};

inline Places corners_of(Geometry g) {
  switch (g) {
    case Geometry::segment: return {{0, 0, 0}, {1, 0, 0}};
    case Geometry::triangle: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    case Geometry::square: return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    case Geometry::tetrahedron: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    case Geometry::prism: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    default: return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  }
}
inline std::vector<std::vector<int>> edges_of(Geometry g) {
  switch (g) {
    case Geometry::triangle: return {{0, 1}, {1, 2}, {2, 0}};
    case Geometry::square: return {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
    case Geometry::tetrahedron: return {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    case Geometry::prism: return {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};
    case Geometry::cube: return {{0, 1}, {1, 2}, {3, 2}, {0, 3}, {4, 5}, {5, 6}, {7, 6}, {4, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
    default: return {};
  }
}
inline std::vector<std::vector<int>> faces_of(Geometry g) {
  switch (g) {
    case Geometry::tetrahedron: return {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    case Geometry::prism: return {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
    case Geometry::cube: return {{3, 2, 1, 0}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}};
    default: return {};
  }
}

/// Where a place of the reference element lies when the element is an affine image of it.
inline Vec3 placed(const Places& vertices, const Element& e, Vec3 r) {
  const Vec3 o = vertices[size_t(e.corners[0])];
  Vec3 x = o;
  const Places ref = corners_of(e.shape);
  for (size_t c = 1; c < ref.size(); ++c) {
    if (ref[c] == Vec3(1, 0, 0)) x += (vertices[size_t(e.corners[c])] - o) * r.x;
    if (ref[c] == Vec3(0, 1, 0)) x += (vertices[size_t(e.corners[c])] - o) * r.y;
    if (ref[c] == Vec3(0, 0, 1)) x += (vertices[size_t(e.corners[c])] - o) * r.z;
  }
  return x;
}

}  // namespace sg::test::mfem_lists
