// SPDX-License-Identifier: Apache-2.0
// Normals of surfaces: smooth, with sharp edges kept sharp.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// Which way polygons face.
enum class Facing { keep, consistent, outward };
constexpr auto enum_words(Facing) {
  using enum Facing;
  return std::array{Word{"keep", keep}, Word{"consistent", consistent}, Word{"outward", outward}};
}

struct NormalsParams {
  double feature_angle = 30;
  Facing orient = Facing::consistent;
  bool flip = false;
  bool cell_normals = false;
};
inline void describe(Schema& s, NormalsParams& p) {
  s("feature_angle", p.feature_angle,
    "Edges with a larger angle stay sharp, by duplicating their points; 180: none. Duplicate points in the file (often in .obj) split the "
    "surface: clean first.")
      .range(0, 180)
      .unit("deg");
  s("orient", p.orient, "Orientation. keep: as the polygons are; consistent: neighbours agree; outward: closed pieces also face outward.");
  s("flip", p.flip, "Reverse all polygons and normals.");
  s("cell_normals", p.cell_normals, "Add the normal of each polygon as cell field 'Cell normals'.");
}

/// Point field "Normals" (f32, unit, role normals): the mean of the normals of the polygons at a point, weighted by their angle
/// there (Thuermer and Wuethrich 1998), so that it does not depend on how a face is cut into triangles. Points on edges sharper than the
/// feature angle, on edges of more than two polygons and where two pieces touch in a point are duplicated, after the points of the input:
/// one per smooth piece of surface around it. Polygons without area do not count; a point with no others gets the zero vector. Consistent
/// orientation follows edges of two polygons; in each piece most polygons stay as they are. All fields are carried; vertices and lines
/// pass. Other mesh kinds: their surface (see surface::polygon_surface). O(corners).
DatasetPtr normals(const DatasetPtr& in, const NormalsParams& p, Context& ctx);

}  // namespace sg
