// SPDX-License-Identifier: Apache-2.0
// Curvature of triangulated surfaces.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct CurvatureParams {
  bool gaussian = true, mean = true, principal = false, angle_defect = false;
  int average = 0;
};
inline void describe(Schema& s, CurvatureParams& p) {
  s("gaussian", p.gaussian, "Add 'Gaussian curvature' (per area).");
  s("mean", p.mean, "Add 'mean curvature' (per length): positive where the surface bends away from its normals, 1/r on a sphere.");
  s("principal", p.principal, "Add 'largest curvature' and 'smallest curvature'.");
  s("angle_defect", p.angle_defect, "Add 'angle defect' (rad), whose sum is 2 pi times the Euler characteristic.");
  s("average", p.average, "Number of area-weighted averaging passes over neighbours: 2 to 5 smooth out noise from thin triangles.")
      .range(0, 1000);
}

/// Point fields (f64) after Meyer, Desbrun, Schroeder and Barr (2003): mean curvature from the cotangent formula, Gaussian curvature
/// from the angle defect, both over the mixed Voronoi area of the point. Polygons are treated as triangles; neighbours are first oriented
/// consistently. At open edges neither formula holds: such points take the mean of their neighbours within (angle defect: pi less the
/// angles, so that its sum stays exact). NaN where there is no such neighbour, on edges of three polygons, and at points without area. Sums
/// run in a fixed order. Other mesh kinds: their surface, as triangles.
DatasetPtr curvature(const DatasetPtr& in, const CurvatureParams& p, Context& ctx);

}  // namespace sg
