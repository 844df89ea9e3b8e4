// SPDX-License-Identifier: Apache-2.0
// The reference elements of MFEM, how their nodes are listed, and how a finite element collection becomes values at the nodes of our
// Lagrange cells. Source of the numbering: the MFEM documentation ("Mesh formats", "Finite element method") and its files.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "data/cells/cell_type.h"

namespace sg::mfem {

/// Numbered as in the files.
enum class Geometry : uint8_t { point, segment, triangle, square, tetrahedron, cube, prism, pyramid };
inline constexpr int geometry_count = 8;

struct GeometryInfo {
  CellType shape;
  int dimension, corners;
  std::vector<std::array<int, 2>> edges;
  std::vector<std::vector<int>> faces;           ///< 3D only
  std::vector<std::array<int, 3>> corner_place;  ///< in the lattice of order 1
};
const GeometryInfo& info(Geometry g);

/// A node of an element of order p in the order in which MFEM lists continuous elements: corners, edges, faces, inside.
struct LocalNode {
  enum Kind : uint8_t { corner, edge, face, inside } kind;
  uint8_t entity;            ///< which corner, edge or face
  std::array<int, 3> place;  ///< in the lattice of order p
  int a = 0, b = 0;          ///< edge: steps from its first corner; face: steps towards its second and its last corner; inside: number
};
std::vector<LocalNode> local_nodes(Geometry g, int p);

enum class Family { h1, l2, nd, rt, nurbs };
enum class Basis { gauss_legendre, gauss_lobatto, bernstein, open_uniform, closed_uniform, open_half };

/// "H1_2D_P3", "L2_T1_3D_P2", "Cubic", ...
struct FeCollection {
  std::string name;
  Family family = Family::h1;
  Basis basis = Basis::gauss_lobatto;
  int order = 1;
  bool listed_as_h1 = false;   ///< discontinuous, but an element lists its nodes corners first
  bool inside_around = false;  ///< "Cubic": the nodes inside a cube go around each layer as corners do, not row by row
};
/// Throws Error(data) naming `where` for a collection that is not read, or an order above 10.
FeCollection parse_collection(std::string_view name, const std::string& where);

/// Fields in H(curl) or H(div), whose values are vectors of space though each degree of freedom is one number.
inline bool is_vector_valued(const FeCollection& c) { return c.family == Family::nd || c.family == Family::rt; }

double binomial(int n, int k);

/// Degrees of freedom of one element (all of its own, for discontinuous ones).
size_t element_dofs(Geometry g, const FeCollection& c);

/// Matrix that takes the degrees of freedom of one element, in its local order, to the values at the nodes of the Lagrange cell of
/// order q: row-major, nodes x dofs. Throws Error(data) for pyramids above order 1.
struct NodeMatrix {
  size_t nodes = 0, dofs = 0;
  std::vector<double> m;
};
NodeMatrix node_matrix(Geometry g, const FeCollection& c, int q, const std::string& where);

/// The n = p + 1 points of a nodal basis on [0, 1], ascending.
std::vector<double> basis_points(Basis basis, int p);

}  // namespace sg::mfem
