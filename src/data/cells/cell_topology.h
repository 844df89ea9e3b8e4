// SPDX-License-Identifier: Apache-2.0
// Edges and faces of every cell type, and how a curved face becomes triangles. Node numbering is VTK's.
//
// Reference orientation: the base is counter-clockwise seen from the top, so that shape functions on it have a positive
// Jacobian (VTK's picture of the wedge shows the mirror image, and files hold both: ask the signed volume, not the table).
//
//   tetra      hexahedron     voxel          wedge        pyramid
//     3          7----6        6----7        3---5          4
//    /|\        /|   /|       /|   /|        |\ /|         /|\.
//   0-+-2      4----5 |      4----5 |        | 4 |        3-+--2
//    \|/       | 3--|-2      | 2--|-3        0-|-2       /    /
//     1        0----1        0----1           \1/       0----1
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "data/mesh.h"

namespace sg {

/// Corners, edges and faces of one linear cell of fixed shape, as a compile-time table.
struct LinearTopology {
  int corners = 0;
  std::span<const std::array<uint8_t, 2>> edges;
  std::span<const uint8_t> face_begin;    ///< faces + 1 entries into face_corners; empty for cells below dimension 3
  std::span<const uint8_t> face_corners;  ///< counter-clockwise seen from outside

  size_t face_count() const { return face_begin.empty() ? 0 : face_begin.size() - 1; }
  std::span<const uint8_t> face(size_t f) const { return face_corners.subspan(face_begin[f], size_t(face_begin[f + 1] - face_begin[f])); }
};

/// The table of a linear type of fixed shape (line, triangle, pixel, quad, tetra, voxel, hexahedron, wedge, pyramid,
/// prisms); null for every other type.
const LinearTopology* linear_topology(CellType type);

/// The linear type with the same corners: quadratic_tetra -> tetra, lagrange_wedge -> wedge; polygons, strips, polyhedra and
/// linear types stay what they are, quadratic_polygon -> polygon, cubic_line -> line.
CellType linear_type(CellType type);
/// Curved: more nodes than corners (quadratic, Lagrange, Bezier).
bool is_high_order(CellType type);
bool is_bezier(CellType type);
/// Polynomial order of a Lagrange or Bezier cell with that many nodes (the same along all axes); 0 when no order fits.
int high_order_of(CellType type, size_t nodes);

/// Faces of a solid cell as 2D cells: local node numbers in the order in which that 2D type lists its nodes, corners first.
struct CellFaces {
  std::vector<CellType> type;
  std::vector<uint32_t> begin{0};  ///< size()+1 entries into nodes
  std::vector<uint32_t> nodes;
  std::vector<uint8_t> corners;            ///< number of corner nodes of each face
  std::vector<std::array<int, 3>> orders;  ///< of Lagrange and Bezier faces along their first and second side; 0 for others

  size_t size() const { return type.size(); }
  std::span<const uint32_t> face(size_t f) const { return std::span(nodes).subspan(begin[f], begin[f + 1] - begin[f]); }
  std::span<const uint32_t> face_corners(size_t f) const { return std::span(nodes).subspan(begin[f], corners[f]); }
};

/// Faces of a 3D cell of `nodes` points; computed once and kept. Cells of other dimensions and polyhedra have none here.
/// A Lagrange or Bezier cell whose node count fits no order has the linear faces of its corners. `orders` of 0: the same along
/// all axes.
const CellFaces& cell_faces(CellType type, size_t nodes, std::array<int, 3> orders = {0, 0, 0});

/// UnstructuredMesh::degrees of a Lagrange or Bezier quad, hexahedron or wedge; 0 for others and where there are none.
std::array<int, 3> cell_orders(const UnstructuredMesh& mesh, size_t cell);

/// Faces of any solid cell of a mesh as lists of point ids, polyhedra included. Not thread-safe: one per thread.
class CellFaceReader {
 public:
  explicit CellFaceReader(const UnstructuredMesh& mesh);
  /// Selects a cell; its number of faces (0 unless the cell is solid).
  size_t open(size_t cell);
  CellType face_type(size_t f) const;
  /// For tessellate_face and CellShape::find.
  std::array<int, 3> face_orders(size_t f) const;
  /// All nodes of face f, in the order of face_type(f).
  std::span<const int64_t> nodes(size_t f);
  /// Its corners only, counter-clockwise seen from outside (a polyhedron's faces as the file lists them).
  std::span<const int64_t> corners(size_t f);

 private:
  std::span<const int64_t> read(size_t f, bool corners_only);
  const UnstructuredMesh& mesh_;
  CellsView cells_, faces_;
  const int64_t* polyhedron_faces_ = nullptr;
  const CellFaces* table_ = nullptr;  // of the open cell; null for a polyhedron
  CellType known_type_ = CellType::empty;
  size_t known_nodes_ = 0;
  std::array<int, 3> known_orders_{0, 0, 0};
  size_t begin_ = 0, first_face_ = 0;
  std::vector<int64_t> ids_;
};

/// Appends triangles (three local node numbers each) that cover a 2D cell of `type` through all of its nodes: n*n per
/// triangle of order n, 2*n*n per quad. `at` holds the position of each node and decides how polygons and quads are split
/// (non-convex ones by ear clipping in their best plane); strips keep their alternating orientation. `orders` as in cell_faces.
void tessellate_face(CellType type, std::span<const Vec3> at, std::vector<uint32_t>& triangles, std::array<int, 3> orders = {0, 0, 0});

/// The nodes of a 1D cell in the order along the curve (0, interior nodes, 1).
void curve_order(CellType type, size_t nodes, std::vector<uint32_t>& order);

/// The nodes of a 2D cell that lie on its outline, in order around it: what to draw as its edges. Strips are not outlines: empty.
void face_outline(CellType type, size_t nodes, std::vector<uint32_t>& ring, std::array<int, 3> orders = {0, 0, 0});

/// Triangles of a simple polygon, also a non-convex one, by ear clipping; n-2 triangles, oriented like the polygon.
void triangulate_polygon(std::span<const Vec3> at, std::vector<uint32_t>& triangles);

/// Whether the triangles a b c and a c d of a quad face the same side; else its other diagonal is the right one.
inline bool first_diagonal_fits(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 across = c - a;
  return !(dot(cross(b - a, across), cross(across, d - a)) < 0);
}

/// Twice the vector area of a polygon (Newell): its direction is the normal, half its length the area.
Vec3 polygon_vector_area(std::span<const Vec3> at);

/// Number of the node at lattice place (i, j, k) of a Lagrange or Bezier cell of order n (curves: i; triangles: i + j <= n;
/// tetrahedra: i + j + k <= n; wedges: i + j <= n).
uint32_t lattice_node(CellType type, int n, int i, int j = 0, int k = 0);
/// The same with an order per axis: quads, hexahedra and wedges (whose first two are equal); others use the first.
uint32_t lattice_node(CellType type, std::array<int, 3> orders, int i, int j = 0, int k = 0);
/// Number of nodes of a Lagrange or Bezier cell of those orders; 0 for pyramids and types without a lattice.
size_t lattice_nodes(CellType type, std::array<int, 3> orders);

}  // namespace sg
