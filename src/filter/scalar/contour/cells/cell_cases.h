// SPDX-License-Identifier: Apache-2.0
// How an isosurface crosses a cell: triangles for every pattern of corners, made only from the cell's faces.
//
// A corner is inside when its value is >= the isovalue. On each face the surface leaves segments between cut edges; together
// the segments of all faces close to loops, which are filled with triangles. On a face of four corners that alternate, one bit
// says whether the inside corners are joined across the face (the asymptotic decider of Nielson and Hamann 1991); both cells
// at a face compute the same bit from the same four values, so their segments agree and the surface has no holes.
// Diagonals of a loop avoid the faces of the cell, since the cell behind the face might have the same one. A few loops (none of
// fewer than 8 edges) cannot be filled so without an extra point; they may join the two edges where segments of the loop enter the
// face. What one cell sees as entries are exits for the other, so again no edge has more than two triangles and no triangle
// appears twice.
//
// Triangles are wound counterclockwise seen from the side of the smaller values (normals point along minus the gradient).
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "data/cells/cell_type.h"

namespace sg {

/// What a table of cases is made from. (Not the CellShape of data/: one name for two classes is undefined behaviour.)
struct CaseShape {
  int corners = 0;
  std::vector<std::vector<uint8_t>> faces;    ///< corners, counterclockwise seen from outside
  std::vector<std::array<uint8_t, 2>> edges;  ///< empty: in order of first appearance in the faces
  std::vector<std::array<float, 3>> place;    ///< corner positions of a regular cell: shorter diagonals are preferred
  std::vector<uint8_t> mirror;                ///< an order of the corners that turns the cell inside out

  void find_edges();
};

class CaseTable {
 public:
  explicit CaseTable(CaseShape shape);

  const CaseShape& shape() const { return shape_; }
  /// Faces of this pattern that need a decider; bit = face number.
  uint32_t ambiguous(uint32_t pattern) const { return ambiguous_[pattern]; }
  /// Edges of the cell, three per triangle. `joined` has a bit per face; only those of ambiguous faces count.
  std::span<const uint8_t> triangles(uint32_t pattern, uint32_t joined) const {
    uint32_t v = first_[pattern];
    if (ambiguous_[pattern]) v += packed(ambiguous_[pattern], joined);
    return {edges_.data() + begin_[v], begin_[v + 1] - begin_[v]};
  }
  /// For patterns without ambiguous faces: begin and end in triangle_edges().
  std::array<uint32_t, 2> plain(uint32_t pattern) const { return {begin_[first_[pattern]], begin_[first_[pattern] + 1]}; }
  const uint8_t* triangle_edges() const { return edges_.data(); }
  /// Closed loops before they are filled: edges, each loop ended by 255.
  std::vector<std::vector<uint8_t>> loops(uint32_t pattern, uint32_t joined) const;
  /// Diagonals that break this rule, over all cases; 0 for every shape of this library (tested).
  int bad_diagonals() const { return bad_; }

 private:
  static uint32_t packed(uint32_t mask, uint32_t bits) {
    uint32_t r = 0;
    for (uint32_t at = 0; mask; mask &= mask - 1, ++at) r |= uint32_t((bits & (mask & (0u - mask))) != 0) << at;
    return r;
  }
  void fill(const std::vector<uint8_t>& loop);
  uint32_t shared_face(uint8_t a, uint8_t b) const { return edge_faces_[a] & edge_faces_[b]; }

  CaseShape shape_;
  std::vector<uint32_t> edge_faces_;
  std::vector<std::vector<uint8_t>> face_edges_;  ///< edge between corner k and k+1 of each face
  std::vector<uint32_t> ambiguous_, first_, begin_;
  std::vector<uint8_t> edges_;
  int bad_ = 0;
};

/// Lattice cell: corner c at (c&1, c>>1&1, c>>2); edges 0-3 along x from corners 0 2 4 6, 4-7 along y from 0 1 4 5, 8-11 along z
/// from 0 1 2 3; faces x0 x1 y0 y1 z0 z1.
const CaseTable& lattice_cases();

/// The table of a linear solid (tetra, pyramid, wedge, hexahedron, voxel, the two prisms) with its file's corner order; null for
/// all other types. Files disagree on which way
/// wedges turn, so users must look at the sign of a cell's volume and take mirrored cells in the order `mirror`. Made on first use.
const CaseTable* cell_cases(CellType type);

/// The cheapest triangulation of a loop of n places: triangles as places in the loop, in its direction. cost(a, b), a < b, is that of
/// the diagonal between two places that are not neighbours.
std::vector<std::array<uint32_t, 3>> fill_loop(size_t n, const std::function<double(size_t, size_t)>& cost);
/// What a diagonal that lies in a face adds to its squared length (in units of the cell's size), by the rule above.
inline double face_penalty(bool from_entry_to_entry) { return from_entry_to_entry ? 1e3 : 1e6; }

/// Whether the bilinear function on a face with alternating signs joins its corners >= 0. Values minus the isovalue, in order around.
inline bool joined_inside(double a, double b, double c, double d) { return a >= 0 ? a * c >= b * d : b * d >= a * c; }

}  // namespace sg
