// SPDX-License-Identifier: Apache-2.0
#include "io/gmsh/elements.h"

#include <algorithm>
#include <map>

#include "base/error.h"
#include "io/text/mesh_text.h"

namespace sg::gmsh {

namespace {

using Place = std::array<int, 3>;
using Places = std::vector<Place>;

struct Shape {
  Places corners;
  std::vector<std::array<int, 2>> edges;
  std::vector<std::vector<int>> faces;
};

const Shape& shape_of(CellType type) {
  static const Shape line{{{0, 0, 0}, {1, 0, 0}}, {{0, 1}}, {}};
  static const Shape triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1}, {1, 2}, {2, 0}}, {}};
  static const Shape quad{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}, {}};
  static const Shape tetra{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                           {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}},
                           {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {3, 1, 2}}};
  static const Shape hexahedron{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
                                {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}},
                                {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}}};
  static const Shape wedge{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
                           {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}},
                           {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {0, 3, 5, 2}, {1, 2, 5, 4}}};
  switch (type) {
    case CellType::line: return line;
    case CellType::triangle: return triangle;
    case CellType::quad: return quad;
    case CellType::tetra: return tetra;
    case CellType::hexahedron: return hexahedron;
    case CellType::wedge: return wedge;
    default: fail_internal("gmsh: a shape has no nodes");
  }
}

Place scaled(Place p, int n) { return {p[0] * n, p[1] * n, p[2] * n}; }
Place moved(Place p, Place from, Place to, int n) {
  for (size_t a = 0; a < 3; ++a) p[a] += (to[a] - from[a]) * n;
  return p;
}

// The nodes inside an element of order n; their own order is that of a smaller element.
void add_inside(CellType type, int n, Places& out) {
  auto shifted = [&](CellType t, int order) {
    for (Place p : node_places(t, order)) {
      for (int a = 0; a < cell_type_info(t).dimension; ++a) ++p[size_t(a)];
      out.push_back(p);
    }
  };
  switch (type) {
    case CellType::line:
      for (int i = 1; i < n; ++i) out.push_back({i, 0, 0});
      break;
    case CellType::triangle:
      if (n > 2) shifted(type, n - 3);
      break;
    case CellType::tetra:
      if (n > 3) shifted(type, n - 4);
      break;
    case CellType::quad:
    case CellType::hexahedron:
      if (n > 1) shifted(type, n - 2);
      break;
    default:
      if (n > 2)
        for (const Place& t : node_places(CellType::triangle, n - 3))
          for (const Place& l : node_places(CellType::line, n - 2)) out.push_back({t[0] + 1, t[1] + 1, l[0] + 1});
  }
}

struct Row {
  CellType shape;
  int first_order;
  bool complete;
  std::vector<int> numbers;  ///< of orders first_order, first_order + 1, ...
};

const std::vector<Row>& rows() {
  using T = CellType;
  static const std::vector<Row> table{
      {T::line, 1, true, {1, 8, 26, 27, 28, 62, 63, 64, 65, 66}},
      {T::triangle, 1, true, {2, 9, 21, 23, 25, 42, 43, 44, 45, 46}},
      {T::quad, 1, true, {3, 10, 36, 37, 38, 47, 48, 49, 50, 51}},
      {T::tetra, 1, true, {4, 11, 29, 30, 31, 71, 72, 73, 74, 75}},
      {T::hexahedron, 1, true, {5, 12, 92, 93, 94, 95, 96, 97, 98}},
      {T::wedge, 1, true, {6, 13, 90, 91, 106, 107, 108, 109, 110}},
      {T::quad, 2, false, {16}},
      {T::hexahedron, 2, false, {17}},
      {T::wedge, 2, false, {18}},
  };
  return table;
}

CellType quadratic(CellType shape, bool complete) {
  using T = CellType;
  switch (shape) {
    case T::line: return T::quadratic_edge;
    case T::triangle: return T::quadratic_triangle;
    case T::quad: return complete ? T::biquadratic_quad : T::quadratic_quad;
    case T::tetra: return T::quadratic_tetra;
    case T::hexahedron: return complete ? T::triquadratic_hexahedron : T::quadratic_hexahedron;
    default: return complete ? T::biquadratic_quadratic_wedge : T::quadratic_wedge;
  }
}

ElementType make(CellType shape, int order, bool complete) {
  ElementType e;
  e.shape = shape;
  e.order = order;
  const Places file = node_places(shape, order), ours = lattice_places(shape, order);
  e.nodes = file.size();
  if (!complete) e.nodes = shape_of(shape).corners.size() + shape_of(shape).edges.size();
  e.cell = order == 2 ? quadratic(shape, complete) : lagrange_type(shape, order);
  // VTK's quadratic cells list their nodes as its Lagrange cells of order 2 do; without inner nodes the list ends early in both.
  for (size_t k = 0; k < e.nodes; ++k) e.from.push_back(uint32_t(std::find(file.begin(), file.end(), ours[k]) - file.begin()));
  return e;
}

std::map<int64_t, ElementType> make_table() {
  std::map<int64_t, ElementType> t;
  for (const Row& row : rows())
    for (size_t i = 0; i < row.numbers.size(); ++i) t[row.numbers[i]] = make(row.shape, row.first_order + int(i), row.complete);
  t[15] = {CellType::vertex, 1, 1, CellType::vertex, {0}};
  t[7] = {CellType::pyramid, 1, 5, CellType::pyramid, {0, 1, 2, 3, 4}};
  t[19] = {CellType::pyramid, 2, 13, CellType::quadratic_pyramid, {0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12}};
  t[14] = t[19];
  t[14].nodes = 14;
  return t;
}

}  // namespace

std::vector<std::array<int, 3>> node_places(CellType type, int n) {
  if (n == 0) return {{0, 0, 0}};
  const Shape& s = shape_of(type);
  Places out;
  for (const Place& c : s.corners) out.push_back(scaled(c, n));
  if (n == 1) return out;
  if (type != CellType::line)
    for (const auto& [a, b] : s.edges)
      for (int i = 1; i < n; ++i) out.push_back(moved(scaled(s.corners[size_t(a)], n), s.corners[size_t(a)], s.corners[size_t(b)], i));
  for (const auto& f : s.faces) {
    Places inner;
    add_inside(f.size() == 3 ? CellType::triangle : CellType::quad, n, inner);
    const Place p0 = s.corners[size_t(f[0])], p1 = s.corners[size_t(f[1])], p2 = s.corners[size_t(f.back())];
    for (const Place& p : inner) out.push_back(moved(moved(scaled(p0, n), p0, p1, p[0]), p0, p2, p[1]));
  }
  add_inside(type, n, out);
  return out;
}

const ElementType* element_type(int64_t number) {
  static const std::map<int64_t, ElementType> table = make_table();
  const auto it = table.find(number);
  return it == table.end() ? nullptr : &it->second;
}

}  // namespace sg::gmsh
