// SPDX-License-Identifier: Apache-2.0
// The surface of a trilinear function inside one cell, with the right topology.
//
// On the faces of the cell the surface is a set of hyperbola arcs; which corners they join is decided by the bilinear function there
// (Nielson and Hamann 1991), so that both cells at a face agree. The arcs close to loops. A surface of a trilinear function has no
// other parts than a disc in each loop, or one tube between two loops and discs in the rest (Natarajan 1994; Chernyaev 1995;
// Nielson 2003). The tube: in the planes w = const the surface is a hyperbola that degenerates to two crossing lines for the roots
// w1, w2 of a quadratic, at (u2,v2) and (u1,v1). The lines through these points and their like along u and v form a closed hexagon
// of straight lines on the surface (Grosso 2016). If it lies in the cell, its lines end on the loops that belong to its
// part of the surface: two loops make a tube round the hexagon, one loop a disc.
//
// Ties: every zero counts as a little more than zero, at corners, at the saddles of faces and at the saddles inside. The result is the
// surface for an isovalue that is lower by less than any number.
#pragma once
#include <array>
#include <cstdint>

#include "filter/scalar/contour/cells/cell_cases.h"

namespace sg {

/// Names of points: 0..11 the cut edges of the cell in the order of lattice_cases() (0-3 along u from corners 0 2 4 6, 4-7 along v from
/// 0 1 4 5, 8-11 along w from 0 1 2 3), 12.. the inner points.
struct TrilinearCell {
  static constexpr int first_inner = 12;
  int triangle_count = 0, inner_count = 0;
  bool tube = false;
  std::array<std::array<uint8_t, 3>, 32> triangles;  ///< counterclockwise seen from the smaller values
  std::array<std::array<double, 3>, 8> inner;        ///< (u,v,w) in (0,1)^3
};

/// `f`: corner values minus the isovalue; corner c lies at u,v,w = bits 0,1,2 of c (lattices and voxels; a hexahedron's corner k is
/// c = hexahedron_corner[k]). Inside is >= 0. The triangles have the faces' arcs as border, each inner edge twice and no edge inside
/// a face of the cell, so that cells put together make a manifold without doubled triangles.
/// Without `places` only the two counts and `tube` are right: faster, for a first pass.
void cut_trilinear(const double f[8], TrilinearCell& out, bool places = true);
inline constexpr std::array<uint8_t, 8> hexahedron_corner{0, 1, 3, 2, 4, 5, 7, 6};

/// Whether this pattern of corners (bit c: inside) can have a surface other than the one that lattice_cases() lists. All patterns with an
/// ambiguous face or two loops; for the others cut_trilinear() returns the listed triangles.
bool needs_trilinear(uint32_t pattern);

}  // namespace sg
