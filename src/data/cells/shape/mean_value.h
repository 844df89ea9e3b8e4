// SPDX-License-Identifier: Apache-2.0
// Mean value coordinates of polygons (Floater 2003; Hormann, Floater 2006 for non-convex ones) and of closed triangle meshes
// (Ju, Schaefer, Warren 2005), and the winding number of a triangle mesh. All reproduce linear functions and sum to 1.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace sg {

/// Weights of the corners of a polygon, in order around it, at x; both are projected along the polygon's normal.
void polygon_weights(std::span<const Vec3> at, Vec3 x, std::span<double> weights);

/// Weights of the points of a closed mesh of triangles (three places in `at` each) at x, on the mesh the linear interpolation.
void solid_weights(std::span<const Vec3> at, std::span<const uint32_t> triangles, Vec3 x, std::span<double> weights);

/// How often a closed mesh winds around x: +-1 inside, 0 outside (sum of solid angles / 4 pi; van Oosterom, Strackee 1983).
double winding_number(std::span<const Vec3> at, std::span<const uint32_t> triangles, Vec3 x);

/// The nearest point of a set of triangles: returns the triangle's number, -1 for none; `l` its barycentric coordinates.
int64_t nearest_triangle(std::span<const Vec3> at, std::span<const uint32_t> triangles, Vec3 x, Vec3& nearest, Vec3& l);

/// Volume of a closed mesh: positive when its triangles are counter-clockwise seen from outside.
double enclosed_volume(std::span<const Vec3> at, std::span<const uint32_t> triangles);

/// Turns triangles so that neighbours agree on their side and the whole is counter-clockwise seen from outside.
/// `face` numbers the face of each triangle; whole faces are turned.
void orient_outward(std::span<const Vec3> at, std::vector<uint32_t>& triangles, std::span<const uint32_t> face);

}  // namespace sg
