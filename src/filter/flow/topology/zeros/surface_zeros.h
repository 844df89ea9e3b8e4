// SPDX-License-Identifier: Apache-2.0
// Critical points of tangential flows on curved surfaces.
#pragma once
#include "filter/flow/topology/critical_points.h"

namespace sg {

/// The surface is its triangles (quads, polygons and curved cells by theirs). Velocities at the points are turned from the plane across
/// the point's normal into that of each triangle by the shortest rotation and interpolated there. Which triangles hold a critical point is
/// decided by the turning of the velocity around them plus the area of their normals on the unit sphere: a whole number, 1 or -1,
/// whose sum over a closed surface is its Euler number whatever the velocities are (Poincare-Hopf). The point is the zero of the
/// interpolant, moved into the triangle if it lies outside. Points of exactly zero velocity belong to one of their triangles. Triangles
/// with two or three of them: spread. Points on the border of a mesh or part that lie at exactly the same place are one. Fills `out`.
void find_surface_zeros(const FlowParts& flow, const CriticalOptions& options, CriticalPoints& out, Context& context);

/// That interpolant as a flow of its own, on triangles that share no points: lines traced in it end where find_surface_zeros() puts the
/// zeros.
FlowParts tangential_flow(const FlowParts& flow, Context& context);

}  // namespace sg
