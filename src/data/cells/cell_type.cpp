// SPDX-License-Identifier: Apache-2.0
#include "data/cells/cell_type.h"

namespace sg {

const CellTypeInfo* cell_type_info(uint8_t type) {
  struct Row {
    CellType type;
    CellTypeInfo info;
  };
  using enum CellType;
  static constexpr Row rows[] = {
      {empty, {"EmptyCell", 0, 0, 0}},
      {vertex, {"Vertex", 0, 1, 1}},
      {poly_vertex, {"PolyVertex", 0, -1, -1}},
      {line, {"Line", 1, 2, 2}},
      {poly_line, {"PolyLine", 1, -1, -1}},
      {triangle, {"Triangle", 2, 3, 3}},
      {triangle_strip, {"TriangleStrip", 2, -1, -1}},
      {polygon, {"Polygon", 2, -1, -1}},
      {pixel, {"Pixel", 2, 4, 4}},
      {quad, {"Quad", 2, 4, 4}},
      {tetra, {"Tetra", 3, 4, 4}},
      {voxel, {"Voxel", 3, 8, 8}},
      {hexahedron, {"Hexahedron", 3, 8, 8}},
      {wedge, {"Wedge", 3, 6, 6}},
      {pyramid, {"Pyramid", 3, 5, 5}},
      {pentagonal_prism, {"PentagonalPrism", 3, 10, 10}},
      {hexagonal_prism, {"HexagonalPrism", 3, 12, 12}},
      {quadratic_edge, {"QuadraticEdge", 1, 3, 2}},
      {quadratic_triangle, {"QuadraticTriangle", 2, 6, 3}},
      {quadratic_quad, {"QuadraticQuad", 2, 8, 4}},
      {quadratic_tetra, {"QuadraticTetra", 3, 10, 4}},
      {quadratic_hexahedron, {"QuadraticHexahedron", 3, 20, 8}},
      {quadratic_wedge, {"QuadraticWedge", 3, 15, 6}},
      {quadratic_pyramid, {"QuadraticPyramid", 3, 13, 5}},
      {biquadratic_quad, {"BiQuadraticQuad", 2, 9, 4}},
      {triquadratic_hexahedron, {"TriQuadraticHexahedron", 3, 27, 8}},
      {quadratic_linear_quad, {"QuadraticLinearQuad", 2, 6, 4}},
      {quadratic_linear_wedge, {"QuadraticLinearWedge", 3, 12, 6}},
      {biquadratic_quadratic_wedge, {"BiQuadraticQuadraticWedge", 3, 18, 6}},
      {biquadratic_quadratic_hexahedron, {"BiQuadraticQuadraticHexahedron", 3, 24, 8}},
      {biquadratic_triangle, {"BiQuadraticTriangle", 2, 7, 3}},
      {cubic_line, {"CubicLine", 1, 4, 2}},
      {quadratic_polygon, {"QuadraticPolygon", 2, -1, -1}},
      {triquadratic_pyramid, {"TriQuadraticPyramid", 3, 19, 5}},
      {polyhedron, {"Polyhedron", 3, -1, -1}},
      {lagrange_curve, {"LagrangeCurve", 1, -1, 2}},
      {lagrange_triangle, {"LagrangeTriangle", 2, -1, 3}},
      {lagrange_quad, {"LagrangeQuadrilateral", 2, -1, 4}},
      {lagrange_tetra, {"LagrangeTetrahedron", 3, -1, 4}},
      {lagrange_hexahedron, {"LagrangeHexahedron", 3, -1, 8}},
      {lagrange_wedge, {"LagrangeWedge", 3, -1, 6}},
      {lagrange_pyramid, {"LagrangePyramid", 3, -1, 5}},
      {bezier_curve, {"BezierCurve", 1, -1, 2}},
      {bezier_triangle, {"BezierTriangle", 2, -1, 3}},
      {bezier_quad, {"BezierQuadrilateral", 2, -1, 4}},
      {bezier_tetra, {"BezierTetrahedron", 3, -1, 4}},
      {bezier_hexahedron, {"BezierHexahedron", 3, -1, 8}},
      {bezier_wedge, {"BezierWedge", 3, -1, 6}},
      {bezier_pyramid, {"BezierPyramid", 3, -1, 5}},
  };
  for (const Row& r : rows)
    if (uint8_t(r.type) == type) return &r.info;
  return nullptr;
}

}  // namespace sg
