// SPDX-License-Identifier: Apache-2.0
#include "io/mfem/element.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/text/text.h"
#include "io/text/mesh_text.h"

namespace sg::mfem {

const GeometryInfo& info(Geometry g) {
  using T = CellType;
  using Places = std::vector<std::array<int, 3>>;
  static const Places triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  static const Places square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  static const GeometryInfo table[geometry_count] = {
      {T::vertex, 0, 1, {}, {}, {{0, 0, 0}}},
      {T::line, 1, 2, {{0, 1}}, {}, {{0, 0, 0}, {1, 0, 0}}},
      {T::triangle, 2, 3, {{0, 1}, {1, 2}, {2, 0}}, {}, triangle},
      {T::quad, 2, 4, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}, {}, square},
      {T::tetra,
       3,
       4,
       {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}},
       {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}},
       {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
      {T::hexahedron,
       3,
       8,
       {{0, 1}, {1, 2}, {3, 2}, {0, 3}, {4, 5}, {5, 6}, {7, 6}, {4, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}},
       {{3, 2, 1, 0}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}},
       {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}},
      {T::wedge,
       3,
       6,
       {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}},
       {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}},
       {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}},
      {T::pyramid,
       3,
       5,
       {{0, 1}, {1, 2}, {3, 2}, {0, 3}, {0, 4}, {1, 4}, {2, 4}, {3, 4}},
       {{3, 2, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}},
       {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}}},
  };
  return table[size_t(g)];
}

std::vector<LocalNode> local_nodes(Geometry g, int p) {
  const GeometryInfo& e = info(g);
  std::vector<LocalNode> nodes;
  auto at = [&](std::initializer_list<std::pair<int, int>> weights) {  // corner, weight; weights sum to p
    std::array<int, 3> place{0, 0, 0};
    for (auto [corner, weight] : weights)
      for (size_t a = 0; a < 3; ++a) place[a] += weight * e.corner_place[size_t(corner)][a];
    return place;
  };
  for (int c = 0; c < e.corners; ++c) nodes.push_back({LocalNode::corner, uint8_t(c), at({{c, p}})});
  if (p == 1 || g == Geometry::point || g == Geometry::pyramid) return nodes;  // pyramids of higher order are refused elsewhere
  if (e.dimension > 1)
    for (size_t k = 0; k < e.edges.size(); ++k)
      for (int a = 1; a < p; ++a) nodes.push_back({LocalNode::edge, uint8_t(k), at({{e.edges[k][0], p - a}, {e.edges[k][1], a}}), a, 0});
  for (size_t f = 0; f < e.faces.size(); ++f) {
    const auto& v = e.faces[f];
    const bool triangle = v.size() == 3;
    for (int b = 1; b < p; ++b)
      for (int a = 1; a < (triangle ? p - b : p); ++a) {
        // On a square the corner v0 carries what is left, so its weight may be negative: v0 + a/p (v1 - v0) + b/p (v3 - v0).
        nodes.push_back({LocalNode::face, uint8_t(f), at({{v[0], p - a - b}, {v[1], a}, {v.back(), b}}), a, b});
      }
  }
  int number = 0;
  auto inside = [&](int i, int j, int k) { nodes.push_back({LocalNode::inside, 0, {i, j, k}, number++, 0}); };
  switch (g) {
    case Geometry::segment:
      for (int i = 1; i < p; ++i) inside(i, 0, 0);
      break;
    case Geometry::triangle:
      for (int j = 1; j < p; ++j)
        for (int i = 1; i + j < p; ++i) inside(i, j, 0);
      break;
    case Geometry::square:
      for (int j = 1; j < p; ++j)
        for (int i = 1; i < p; ++i) inside(i, j, 0);
      break;
    default: {
      const bool tet = g == Geometry::tetrahedron, wedge = g == Geometry::prism;
      for (int k = 1; k < p; ++k)
        for (int j = 1; j < p - (tet ? k : 0); ++j)
          for (int i = 1; i < p - (tet ? k + j : wedge ? j : 0); ++i) inside(i, j, k);
    }
  }
  return nodes;
}

namespace {

/// Takes "PREFIX" off the front.
bool take(std::string_view& s, std::string_view prefix) {
  if (!s.starts_with(prefix)) return false;
  s.remove_prefix(prefix.size());
  return true;
}

constexpr const char* readable =
    "supported: H1_, H1Pos_, L2_, L2_T1_, DG_, ND_, RT_, Linear, Quadratic, Cubic, Const and NURBS collections";

Basis basis_of(int64_t number, std::string_view name, const std::string& where) {
  constexpr Basis by_number[] = {Basis::gauss_legendre, Basis::gauss_lobatto,  Basis::bernstein,
                                 Basis::open_uniform,   Basis::closed_uniform, Basis::open_half};
  if (number < 0 || number > 5) fail_data(fmt::format("the basis of the collection '{}' is unknown", name), where, readable);
  return by_number[number];
}

/// The fixed collections of the first MFEM files: nodes at equal distances.
bool parse_fixed(std::string_view name, FeCollection& c) {
  struct Fixed {
    std::string_view name;
    Family family;
    int order;
  };
  static constexpr Fixed table[] = {{"Linear", Family::h1, 1},
                                    {"Quadratic", Family::h1, 2},
                                    {"QuadraticPos", Family::h1, 2},
                                    {"Cubic", Family::h1, 3},
                                    {"Const2D", Family::l2, 0},
                                    {"Const3D", Family::l2, 0},
                                    {"LinearDiscont2D", Family::l2, 1},
                                    {"LinearDiscont3D", Family::l2, 1},
                                    {"QuadraticDiscont2D", Family::l2, 2},
                                    {"QuadraticDiscont3D", Family::l2, 2},
                                    {"CubicDiscont2D", Family::l2, 3}};
  for (const Fixed& f : table)
    if (name == f.name) {
      c.family = f.family;
      c.order = f.order;
      c.basis = name == "QuadraticPos" ? Basis::bernstein : Basis::closed_uniform;
      c.listed_as_h1 = f.family == Family::l2 && f.order > 0;
      c.inside_around = name == "Cubic";
      return true;
    }
  return false;
}

}  // namespace

FeCollection parse_collection(std::string_view name, const std::string& where) {
  FeCollection c;
  c.name = std::string(name);
  if (parse_fixed(name, c)) return c;
  std::string_view s = name;
  auto unknown = [&]() { fail_data(fmt::format("the finite element collection '{}' is not supported", name), where, readable); };
  auto number = [&](std::string_view digits) {
    const auto n = parse_int(digits);
    if (!n || *n < 0) unknown();
    if (*n > 10) fail_data(fmt::format("the collection '{}' has order {}", name, *n), where, "orders up to 10 are supported");
    return int(*n);
  };
  if (take(s, "NURBS")) {
    c.family = Family::nurbs;
    c.order = s.empty() ? 0 : number(s);
    return c;
  }
  if (take(s, "H1Pos_")) {
    c.basis = Basis::bernstein;
  } else if (take(s, "H1@")) {
    c.basis = s.starts_with("U_")   ? Basis::closed_uniform
              : s.starts_with("P_") ? Basis::bernstein
              : s.starts_with("G_") ? Basis::gauss_lobatto
                                    : (unknown(), Basis::gauss_lobatto);
    s.remove_prefix(2);
  } else if (take(s, "H1_")) {
    c.basis = Basis::gauss_lobatto;
  } else if (take(s, "L2_") || take(s, "DG_")) {
    c.family = Family::l2;
    c.basis = Basis::gauss_legendre;
    if (take(s, "T")) {
      const size_t end = s.find('_');
      if (end == std::string_view::npos) unknown();
      c.basis = basis_of(number(s.substr(0, end)), name, where);
      s.remove_prefix(end + 1);
    }
  } else if (take(s, "ND_")) {
    c.family = Family::nd;
  } else if (take(s, "RT_")) {
    c.family = Family::rt;
  } else {
    unknown();
  }
  // What is left reads "2D_P3".
  if (s.size() < 5 || s[0] < '0' || s[0] > '3' || s.substr(1, 3) != "D_P") unknown();
  c.order = number(s.substr(4));
  if ((c.family == Family::h1 || c.family == Family::nd) && c.order < 1) unknown();
  return c;
}

size_t element_dofs(Geometry g, const FeCollection& c) {
  const auto p = size_t(c.order);
  switch (g) {
    case Geometry::point: return 1;
    case Geometry::segment: return p + 1;
    case Geometry::triangle: return (p + 1) * (p + 2) / 2;
    case Geometry::square: return (p + 1) * (p + 1);
    case Geometry::tetrahedron: return (p + 1) * (p + 2) * (p + 3) / 6;
    case Geometry::cube: return (p + 1) * (p + 1) * (p + 1);
    case Geometry::prism: return (p + 1) * (p + 1) * (p + 2) / 2;
    case Geometry::pyramid: return p == 0 ? 1 : p == 1 ? 5 : (p + 1) * (p + 2) * (2 * p + 3) / 6;
  }
  return 0;
}

}  // namespace sg::mfem
