// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/node_order.h"

#include <algorithm>

namespace sg {

namespace {

constexpr NodeMask m(int a) { return NodeMask(1 << a); }
constexpr NodeMask m(int a, int b) { return NodeMask(m(a) | m(b)); }
constexpr NodeMask m(int a, int b, int c) { return NodeMask(m(a, b) | m(c)); }
constexpr NodeMask m(int a, int b, int c, int d) { return NodeMask(m(a, b) | m(c, d)); }
constexpr NodeMask all8 = 255;

// Each list ends with the highest type; those of lower degree are its beginnings.
constexpr NodeMask line[] = {m(0), m(1), m(0, 1)};
constexpr NodeMask triangle[] = {m(0), m(1), m(2), m(0, 1), m(1, 2), m(2, 0), m(0, 1, 2)};
constexpr NodeMask quad[] = {m(0), m(1), m(2), m(3), m(0, 1), m(1, 2), m(2, 3), m(3, 0), m(0, 1, 2, 3)};
constexpr NodeMask tetra[] = {m(0), m(1), m(2), m(3), m(0, 1), m(1, 2), m(2, 0), m(0, 3), m(1, 3), m(2, 3)};
constexpr NodeMask pyramid[] = {m(0),    m(1),    m(2),    m(3),          m(4),       m(0, 1),    m(1, 2),    m(2, 3),    m(3, 0), m(0, 4),
                                m(1, 4), m(2, 4), m(3, 4), m(0, 1, 2, 3), m(0, 1, 4), m(1, 2, 4), m(2, 3, 4), m(3, 0, 4), 31};
constexpr NodeMask wedge[] = {m(0),    m(1),    m(2),    m(3),    m(4),    m(5),    m(0, 1),       m(1, 2),       m(2, 0),
                              m(3, 4), m(4, 5), m(5, 3), m(0, 3), m(1, 4), m(2, 5), m(0, 1, 4, 3), m(1, 2, 5, 4), m(2, 0, 3, 5)};
constexpr NodeMask hexahedron[] = {m(0),          m(1),          m(2),          m(3),          m(4),          m(5),    m(6),
                                   m(7),          m(0, 1),       m(1, 2),       m(2, 3),       m(3, 0),       m(4, 5), m(5, 6),
                                   m(6, 7),       m(7, 4),       m(0, 4),       m(1, 5),       m(2, 6),       m(3, 7), m(0, 4, 7, 3),
                                   m(1, 2, 6, 5), m(0, 1, 5, 4), m(3, 7, 6, 2), m(0, 3, 2, 1), m(4, 5, 6, 7), all8};

}  // namespace

std::span<const NodeMask> vtk_nodes(CellType type) {
  const auto first = [](const auto& list, size_t n) { return std::span<const NodeMask>(list).first(n); };
  switch (type) {
    case CellType::vertex: return first(line, 1);
    case CellType::line: return first(line, 2);
    case CellType::quadratic_edge: return first(line, 3);
    case CellType::triangle: return first(triangle, 3);
    case CellType::quadratic_triangle: return first(triangle, 6);
    case CellType::biquadratic_triangle: return first(triangle, 7);
    case CellType::quad: return first(quad, 4);
    case CellType::quadratic_quad: return first(quad, 8);
    case CellType::biquadratic_quad: return first(quad, 9);
    case CellType::tetra: return first(tetra, 4);
    case CellType::quadratic_tetra: return first(tetra, 10);
    case CellType::pyramid: return first(pyramid, 5);
    case CellType::quadratic_pyramid: return first(pyramid, 13);
    case CellType::triquadratic_pyramid: return first(pyramid, 19);
    case CellType::wedge: return first(wedge, 6);
    case CellType::quadratic_wedge: return first(wedge, 15);
    case CellType::biquadratic_quadratic_wedge: return first(wedge, 18);
    case CellType::hexahedron: return first(hexahedron, 8);
    case CellType::quadratic_hexahedron: return first(hexahedron, 20);
    case CellType::triquadratic_hexahedron: return first(hexahedron, 27);
    default: return {};
  }
}

std::vector<uint8_t> node_order(CellType type, std::span<const NodeMask> file) {
  std::vector<uint8_t> order;
  for (const NodeMask node : vtk_nodes(type)) {
    const auto at = std::find(file.begin(), file.end(), node);
    if (at == file.end()) return {};
    order.push_back(uint8_t(at - file.begin()));
  }
  return order;
}

CellSide cell_side(std::span<const uint8_t> corners, std::span<const NodeMask> file) {
  constexpr CellType types[4][3] = {{CellType::vertex, CellType::vertex, CellType::vertex},
                                    {CellType::quadratic_edge, CellType::quadratic_edge, CellType::line},
                                    {CellType::biquadratic_triangle, CellType::quadratic_triangle, CellType::triangle},
                                    {CellType::biquadratic_quad, CellType::quadratic_quad, CellType::quad}};
  if (corners.empty() || corners.size() > 4) return {};
  for (const CellType type : types[corners.size() - 1]) {
    CellSide side{type, {}};
    for (const NodeMask node : vtk_nodes(type)) {
      NodeMask wanted = 0;  // the node's corners, as corners of the cell
      for (size_t k = 0; k < corners.size(); ++k)
        if (node >> k & 1) wanted = NodeMask(wanted | 1 << corners[k]);
      const auto at = std::find(file.begin(), file.end(), wanted);
      if (at == file.end()) break;
      side.nodes.push_back(uint8_t(at - file.begin()));
    }
    if (side.nodes.size() == vtk_nodes(type).size()) return side;
  }
  return {};
}

}  // namespace sg
