// SPDX-License-Identifier: Apache-2.0
// Vector-valued elements of MFEM: Raviart-Thomas (RT, in H(div)) and Nedelec (ND, in H(curl)). A degree of freedom is a value of the
// reference field at a place, along a tangent of an edge or face (ND) or across it (RT), t or n not normed; mapped by Piola's
// transformation it is u . (J t), or u . (J t1 x J t2), of the field u in space, so that neighbours share it whatever their frames.
// Source of places and order: MFEM's documentation ("Finite element method") and fem/fe/fe_rt.cpp, fe_nd.cpp of MFEM 4.8.
#pragma once
#include "base/vec.h"
#include "io/mfem/element.h"

namespace sg::mfem {

/// û(at) . direction, in coordinates of the reference element.
struct VectorDof {
  Vec3 at, direction;
};

/// Degrees of freedom of an edge (corners = 2) or a face (3, 4) in a frame of its own: corner 0 at the origin, x to corner 1, y to the
/// last corner, z across. Their directions are tangents (x, y) for ND, and z for RT. None where the family has none there: RT on
/// edges of solids, faces of ND_P1.
std::vector<VectorDof> entity_dofs(const FeCollection& c, int corners, int dimension);

/// All degrees of freedom of an element: of its edges, of its faces (in their own order of corners), inside.
std::vector<VectorDof> vector_dofs(Geometry g, const FeCollection& c);
/// How many of them lie inside.
size_t inside_vector_dofs(Geometry g, const FeCollection& c);

/// Matrix that takes these to the reference field at the nodes of the Lagrange cell of order q: rows are the nodes' three components.
/// Throws Error(data) for segments and pyramids, and above order 6.
NodeMatrix vector_matrix(Geometry g, const FeCollection& c, int q, const std::string& where);

/// The degree up to which the element's fields reach: p for ND_Pp, k + 1 for RT_Pk.
int vector_degree(const FeCollection& c);

}  // namespace sg::mfem
