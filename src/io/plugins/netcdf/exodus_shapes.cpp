// SPDX-License-Identifier: Apache-2.0
// Shapes after the Exodus II file format manual (Sandia), section "Element types". Nodes beyond those that a VTK type has (a centre
// of a TET11, say) are left out.
#include "io/plugins/netcdf/exodus_shapes.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"

namespace sg::nc {

namespace {

constexpr NodeMask mask(std::initializer_list<int> corners) {
  int m = 0;
  for (const int c : corners) m |= 1 << c;
  return NodeMask(m);
}

constexpr NodeMask bar[] = {1, 2, 3};
constexpr NodeMask tri[] = {1, 2, 4, mask({0, 1}), mask({1, 2}), mask({0, 2}), 7};
constexpr NodeMask quad[] = {1, 2, 4, 8, mask({0, 1}), mask({1, 2}), mask({2, 3}), mask({0, 3}), 15};
constexpr NodeMask tetra[] = {1, 2, 4, 8, mask({0, 1}), mask({1, 2}), mask({0, 2}), mask({0, 3}), mask({1, 3}), mask({2, 3})};
constexpr NodeMask pyramid[] = {
    1, 2, 4, 8, 16, mask({0, 1}), mask({1, 2}), mask({2, 3}), mask({0, 3}), mask({0, 4}), mask({1, 4}), mask({2, 4}), mask({3, 4})};
constexpr NodeMask wedge[] = {1,
                              2,
                              4,
                              8,
                              16,
                              32,
                              mask({0, 1}),
                              mask({1, 2}),
                              mask({0, 2}),
                              mask({0, 3}),
                              mask({1, 4}),
                              mask({2, 5}),
                              mask({3, 4}),
                              mask({4, 5}),
                              mask({3, 5}),
                              mask({0, 1, 4, 3}),
                              mask({1, 2, 5, 4}),
                              mask({2, 0, 3, 5})};
constexpr NodeMask hex[] = {1,
                            2,
                            4,
                            8,
                            16,
                            32,
                            64,
                            128,
                            mask({0, 1}),
                            mask({1, 2}),
                            mask({2, 3}),
                            mask({0, 3}),
                            mask({0, 4}),
                            mask({1, 5}),
                            mask({2, 6}),
                            mask({3, 7}),
                            mask({4, 5}),
                            mask({5, 6}),
                            mask({6, 7}),
                            mask({4, 7}),
                            255,
                            mask({0, 1, 2, 3}),
                            mask({4, 5, 6, 7}),
                            mask({0, 3, 7, 4}),
                            mask({1, 2, 6, 5}),
                            mask({0, 1, 5, 4}),
                            mask({2, 3, 7, 6})};

using Sides = std::vector<SideCorners>;
const Sides bar_sides = {{0}, {1}};
const Sides tri_sides = {{0, 1}, {1, 2}, {2, 0}};
const Sides quad_sides = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
// Shells: both faces, then the edges.
const Sides tri_shell_sides = {{0, 1, 2}, {0, 2, 1}, {0, 1}, {1, 2}, {2, 0}};
const Sides shell_sides = {{0, 1, 2, 3}, {0, 3, 2, 1}, {0, 1}, {1, 2}, {2, 3}, {3, 0}};
const Sides tetra_sides = {{0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 2, 1}};
const Sides pyramid_sides = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {0, 4, 3}, {0, 3, 2, 1}};
const Sides wedge_sides = {{0, 1, 4, 3}, {1, 2, 5, 4}, {0, 3, 5, 2}, {0, 2, 1}, {3, 4, 5}};
const Sides hex_sides = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {0, 4, 7, 3}, {0, 3, 2, 1}, {4, 5, 6, 7}};

constexpr CellType bar_types[] = {CellType::quadratic_edge, CellType::line};
constexpr CellType tri_types[] = {CellType::biquadratic_triangle, CellType::quadratic_triangle, CellType::triangle};
constexpr CellType quad_types[] = {CellType::biquadratic_quad, CellType::quadratic_quad, CellType::quad};
constexpr CellType tetra_types[] = {CellType::quadratic_tetra, CellType::tetra};
constexpr CellType pyramid_types[] = {CellType::quadratic_pyramid, CellType::pyramid};
constexpr CellType wedge_types[] = {CellType::biquadratic_quadratic_wedge, CellType::quadratic_wedge, CellType::wedge};
constexpr CellType hex_types[] = {CellType::triquadratic_hexahedron, CellType::quadratic_hexahedron, CellType::hexahedron};

enum class Family { none, bar, tri, quad, tetra, pyramid, wedge, hex, points, polygons, polyhedra };

// By the beginning of the name in capitals, without digits and blanks.
Family family_of(std::string_view name) {
  constexpr std::pair<std::string_view, Family> beginnings[] = {
      {"HEX", Family::hex},    {"TET", Family::tetra},  {"WED", Family::wedge},    {"PYR", Family::pyramid},   {"QUA", Family::quad},
      {"TRI", Family::tri},    {"SHE", Family::quad},   {"NSI", Family::polygons}, {"NFA", Family::polyhedra}, {"BAR", Family::bar},
      {"BEA", Family::bar},    {"TRU", Family::bar},    {"ROD", Family::bar},      {"EDG", Family::bar},       {"LIN", Family::bar},
      {"STR", Family::bar},    {"SPR", Family::bar},    {"SPH", Family::points},   {"CIR", Family::points},    {"POI", Family::points},
      {"SUP", Family::points}, {"UTS", Family::points}, {"NOD", Family::points},   {"MEM", Family::quad},
  };
  for (const auto& [beginning, family] : beginnings)
    if (name.starts_with(beginning)) return family;
  return Family::none;
}

Family guess(size_t nodes, int space) {
  switch (nodes) {
    case 1: return Family::points;
    case 2: return Family::bar;
    case 3: return space == 1 ? Family::bar : Family::tri;
    case 4: return space == 3 ? Family::tetra : Family::quad;
    case 5: return Family::pyramid;
    case 6: return space == 3 ? Family::wedge : Family::tri;
    case 9: return Family::quad;
    case 10: return Family::tetra;
    case 13: return Family::pyramid;
    case 15:
    case 18: return Family::wedge;
    case 8: return space == 3 ? Family::hex : Family::quad;
    case 20:
    case 27: return Family::hex;
    default: return Family::none;
  }
}

void fit(ExodusShape& shape, std::span<const NodeMask> nodes, size_t count, std::span<const CellType> types) {
  shape.nodes = nodes.first(std::min(count, nodes.size()));
  for (const CellType t : types) {
    shape.order = node_order(t, shape.nodes);
    shape.type = t;
    if (!shape.order.empty()) break;
  }
}

// Families whose nodes between two listed numbers mean something else than the list's beginning (TET8: faces; WEDGE16: the centre).
size_t usable(Family f, size_t nodes) {
  const auto step = [&](std::initializer_list<size_t> steps) {
    size_t best = 0;
    for (const size_t s : steps)
      if (s <= nodes) best = s;
    return best ? best : nodes;
  };
  switch (f) {
    case Family::bar: return step({2, 3});
    case Family::tri: return step({3, 6, 7});
    case Family::quad: return nodes == 3 || nodes == 6 || nodes == 7 ? nodes : step({4, 8, 9});
    case Family::tetra: return step({4, 10});
    case Family::pyramid: return step({5, 13});
    case Family::wedge: return nodes == 18 ? 18 : step({6, 15});
    case Family::hex: return nodes == 27 ? 27 : step({8, 20});
    default: return nodes;
  }
}

}  // namespace

ExodusShape exodus_shape(std::string_view full_name, size_t nodes, int space) {
  std::string name;
  for (const char c : full_name)
    if (c > ' ') name += c >= 'a' && c <= 'z' ? char(c - 32) : c;
  ExodusShape shape;
  Family family = name.empty() ? guess(nodes, space) : family_of(name);
  if (family == Family::none && !name.empty()) family = guess(nodes, space);
  // A shell of three nodes is a triangle.
  if (family == Family::quad && (nodes == 3 || nodes == 6 || nodes == 7)) family = Family::tri;
  const size_t n = usable(family, nodes);
  switch (family) {
    case Family::bar: shape.dimension = 1, shape.sides = bar_sides, fit(shape, bar, n, bar_types); break;
    case Family::tri: shape.dimension = 2, shape.sides = space == 3 ? tri_shell_sides : tri_sides, fit(shape, tri, n, tri_types); break;
    case Family::quad: shape.dimension = 2, shape.sides = space == 3 ? shell_sides : quad_sides, fit(shape, quad, n, quad_types); break;
    case Family::tetra: shape.dimension = 3, shape.sides = tetra_sides, fit(shape, tetra, n, tetra_types); break;
    case Family::pyramid: shape.dimension = 3, shape.sides = pyramid_sides, fit(shape, pyramid, n, pyramid_types); break;
    case Family::wedge: shape.dimension = 3, shape.sides = wedge_sides, fit(shape, wedge, n, wedge_types); break;
    case Family::hex: shape.dimension = 3, shape.sides = hex_sides, fit(shape, hex, n, hex_types); break;
    case Family::points: shape.kind = ShapeKind::points, shape.type = nodes == 1 ? CellType::vertex : CellType::poly_vertex; return shape;
    case Family::polygons: shape.kind = ShapeKind::polygons, shape.dimension = 2, shape.type = CellType::polygon; return shape;
    case Family::polyhedra: shape.kind = ShapeKind::polyhedra, shape.dimension = 3, shape.type = CellType::polyhedron; return shape;
    case Family::none: break;
  }
  if (shape.order.empty())
    fail_data(fmt::format("elements '{}' of {} nodes have an unknown shape", trim(full_name), nodes), {},
              "supported: HEX, TET, WEDGE, PYRAMID, QUAD, TRI, SHELL, BAR, BEAM, TRUSS, SPHERE, NSIDED, NFACED with their linear and "
              "quadratic nodes");
  return shape;
}

}  // namespace sg::nc
