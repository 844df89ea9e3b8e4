// SPDX-License-Identifier: Apache-2.0
// How a cell is split along a function: solid pieces for the corners on either side, made only from the cell's faces.
//
// A corner is inside when its value is >= 0. Each face is divided into triangles and quads only by its own values, so that the cells on
// both sides divide it alike:
//
//   one corner cut off        two and two           opposite corners joined
//   d--e..o                   D----C                D..,--C
//   |\  \ :                   |    |                : /  /:   (or two triangles, by the asymptotic decider)
//   |  \  a                   c1---c2               ,   / ,
//   c----b                    A....B                A--'..B
//
// What is kept of the faces, closed by the cut surface (the same triangles and quads for both sides), is a polyhedron. Where it is a
// tetrahedron, pyramid, wedge or hexahedron it is that; else its faces become pyramids and tetrahedra over the mean of its vertices, or,
// where values are so rough that one of these would turn inside out, over the middle of the cell.
// The pieces of both sides add up to the cell, and no face between two pieces is left without a partner.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "data/cells/cell_topology.h"

namespace sg::clipping {

/// Codes of vertices: corners from 0, the cut of edge e at first_cut + e, points inside the cell from first_inner on.
constexpr uint8_t first_cut = 8, first_inner = 20, max_codes = 32;

struct Piece {
  CellType type;
  uint8_t count;
  uint8_t v[8];  ///< in the order of `type`
};
/// A point inside the cell: the mean of others, or the share `t` of the way from the first of two to the second.
struct Inner {
  std::vector<uint8_t> of;
  double t = -1;
  uint8_t corners = 0;  ///< bit per corner of the cell that has a share in it
};
/// One side of a cell.
struct Region {
  std::vector<Piece> pieces;
  std::vector<Inner> inner;
  uint32_t used = 0;  ///< bit per code below first_inner
  uint32_t ids = 0;   ///< vertices of all pieces
};
/// A face of a cut surface and the inner point over it; count is 3 or 4.
struct Cone {
  uint8_t count, v[4], apex;
  bool inside;
};
struct Sides {
  Region in, out;
  std::vector<Cone> cones;  ///< that could be inside out
};

/// All patterns of a tetrahedron, pyramid, wedge, voxel or hexahedron.
class ClipTable {
 public:
  explicit ClipTable(CellType type);
  const LinearTopology& topology() const { return *topology_; }
  /// Faces of four corners that alternate; bit = face number.
  uint32_t ambiguous(uint32_t pattern) const { return ambiguous_[pattern]; }
  /// `joined` says of each ambiguous face whether its inside corners are joined. No value is zero.
  const Sides& sides(uint32_t pattern, uint32_t joined) const { return sides_[variant(pattern, joined)]; }
  /// Place of that among all of them, and what is there.
  uint32_t variant(uint32_t pattern, uint32_t joined) const;
  const Sides& at(uint32_t variant) const { return sides_[variant]; }
  /// The same where some values are zero (these corners are in the pattern): cuts at them are the corners themselves.
  void sides(uint32_t pattern, uint32_t joined, uint32_t zero, Sides& out) const;
  /// Whether some piece over an inner point can be inside out, for the values `h` of the corners. `places` are those of the corners;
  /// without them, those of the regular cell. Parts of the cell's own faces never are, as these are flat. `shares`: for each edge where its
  /// cut is moved to, from its first corner on; without them where h is zero. Means over cuts stay.
  bool folded(const Sides& sides, const double* h, const Vec3* places = nullptr, const double* shares = nullptr) const;
  /// Pieces that are never inside out: the faces' parts over the middle of the cell, cut along the rays to it. More of them.
  void star_sides(uint32_t pattern, uint32_t joined, uint32_t zero, const double* h, Sides& out) const;
  /// The cut surface of a pattern without ambiguous faces: cuts as codes, counter-clockwise seen from the inside corners.
  const std::vector<std::vector<uint8_t>>& loops(uint32_t pattern) const { return loops_[pattern]; }
  int edge(int a, int b) const { return edge_of_[size_t(a)][size_t(b)]; }

 private:
  using Polygon = std::vector<uint8_t>;
  struct Faces {
    std::vector<Polygon> in, out;
  };
  void divide(std::span<const uint8_t> face, uint32_t pattern, bool joined, uint32_t zero, Faces& faces) const;
  Faces divided_faces(uint32_t pattern, uint32_t joined, uint32_t zero) const;
  void add_cut(Faces faces, uint32_t zero, Sides& out) const;
  void divide_loop(const Polygon& loop, std::vector<Polygon>& out) const;
  void find_cones(uint32_t zero, Sides& s) const;
  Vec3 middle_of(uint8_t code) const;
  uint32_t faces_of(uint8_t code) const;

  const LinearTopology* topology_;
  std::vector<std::array<double, 3>> place_;
  std::array<std::array<int8_t, 8>, 8> edge_of_;
  std::array<uint8_t, 3> beside_{};  // the corners joined to the first one, in right-handed order
  std::array<uint32_t, 8> corner_faces_{};
  std::vector<uint32_t> ambiguous_, first_;
  std::vector<Sides> sides_;
  std::vector<std::vector<Polygon>> loops_;
};

/// The table of a tetra, pyramid, wedge, voxel or hexahedron, made on first use; null for all other types.
const ClipTable* clip_table(CellType type);

/// Whether the bilinear function on a face with alternating signs joins its corners >= 0. Values in order around (Nielson, Hamann 1991).
inline bool joined_across(double a, double b, double c, double d) { return a >= 0 ? a * c >= b * d : b * d >= a * c; }

}  // namespace sg::clipping
