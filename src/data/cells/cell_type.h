// SPDX-License-Identifier: Apache-2.0
// Cell types, numbered as in VTK files.
#pragma once
#include <cstdint>
#include <string_view>

namespace sg {

enum class CellType : uint8_t {
  empty = 0,
  vertex = 1,
  poly_vertex = 2,
  line = 3,
  poly_line = 4,
  triangle = 5,
  triangle_strip = 6,
  polygon = 7,
  pixel = 8,
  quad = 9,
  tetra = 10,
  voxel = 11,
  hexahedron = 12,
  wedge = 13,
  pyramid = 14,
  pentagonal_prism = 15,
  hexagonal_prism = 16,
  quadratic_edge = 21,
  quadratic_triangle = 22,
  quadratic_quad = 23,
  quadratic_tetra = 24,
  quadratic_hexahedron = 25,
  quadratic_wedge = 26,
  quadratic_pyramid = 27,
  biquadratic_quad = 28,
  triquadratic_hexahedron = 29,
  quadratic_linear_quad = 30,
  quadratic_linear_wedge = 31,
  biquadratic_quadratic_wedge = 32,
  biquadratic_quadratic_hexahedron = 33,
  biquadratic_triangle = 34,
  cubic_line = 35,
  quadratic_polygon = 36,
  triquadratic_pyramid = 37,
  polyhedron = 42,
  lagrange_curve = 68,
  lagrange_triangle = 69,
  lagrange_quad = 70,
  lagrange_tetra = 71,
  lagrange_hexahedron = 72,
  lagrange_wedge = 73,
  lagrange_pyramid = 74,
  bezier_curve = 75,
  bezier_triangle = 76,
  bezier_quad = 77,
  bezier_tetra = 78,
  bezier_hexahedron = 79,
  bezier_wedge = 80,
  bezier_pyramid = 81
};

struct CellTypeInfo {
  std::string_view name;  ///< VTK's name without the prefix: "Tetra", "TriQuadraticHexahedron"
  int dimension;          ///< 0 point, 1 curve, 2 surface, 3 solid
  int points;             ///< number of points, -1 = any
  int corners;            ///< corner points of cells with a fixed shape; -1 for polygons, strips, polyhedra, ...
};

/// Null for a number that is not a cell type.
const CellTypeInfo* cell_type_info(uint8_t type);
inline const CellTypeInfo& cell_type_info(CellType t) { return *cell_type_info(uint8_t(t)); }

}  // namespace sg
