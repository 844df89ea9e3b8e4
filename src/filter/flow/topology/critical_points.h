// SPDX-License-Identifier: Apache-2.0
// Stagnation points of a flow, and its motion around them.
#pragma once
#include <optional>
#include <vector>

#include "base/schema/schema.h"
#include "filter/flow/flow_parts.h"
#include "filter/flow/topology/zeros/linearisation.h"
#include "filter/flow/topology/zeros/plane_frame.h"

namespace sg {

struct CriticalPoint {
  Vec3 at;
  Mat3 gradient;       ///< of the interpolant; where several cells meet in the point, the mean of theirs
  Linearisation flow;  ///< in 2D: within the surface
  int index = 0;       ///< Poincare index: 1 or -1; 0 where it is not known
  int64_t cell = -1;   ///< the smallest of the cells that hold it
  int32_t part = 0;    ///< of a collection, among those that have the flow
  double size = 0;     ///< of that cell: diagonal of its box
  double speed = 0;    ///< largest at that cell's points
  double moved = 0;    ///< curved surfaces: how far outside of its triangle the zero of the interpolant lies
};

/// In order of their parts and cells. `plane` for flat meshes of 2D cells; `normal` of curved ones per point.
struct CriticalPoints {
  int dimension = 3;
  std::optional<PlaneFrame> plane;
  std::vector<CriticalPoint> points;
  std::vector<Vec3> normal;        ///< of the surface at each point; empty for solids
  size_t spread = 0;               ///< cells with lines or areas of zeros, which are not reported
  size_t noise = 0;                ///< points left out as noise
  double slow = 0;                 ///< the speed below which they were, if any: lines that stay below it wander in noise
  std::optional<int> faces_index;  ///< curved surfaces: sum of the indices of all triangles (the Euler number of a closed surface)
};

struct CriticalOptions {
  double centre = 1e-3;  ///< see linearise()
  double min_speed = 0;  ///< cells that are slower than this part of the largest speed at all their points are left out
  double noise =
      0;  ///< of points in cells that are as slow at all their points, those are left out that have another one within three cells
};
/// All isolated zeros of the interpolated velocity. Solids: zeros in space. Flat 2D meshes: of the part in their plane. Curved surfaces:
/// see surface_zeros.h. The interpolant decides the class, but for foci of flat meshes that grow by less than a tenth of their turning:
/// when the mean divergence over some cells does not bear that out by half, they are centres. Zeros on faces, edges and points of several
/// cells are one, also of several patches and parts. The same for any number of threads. Throws Error(usage) for meshes of lines.
CriticalPoints find_critical_points(const FlowParts& flow, const CriticalOptions& options, Context& context);
inline CriticalPoints find_critical_points(const FlowField& flow, const CriticalOptions& options, Context& context) {
  return find_critical_points(FlowParts(flow), options, context);
}
void describe(Schema& s, CriticalOptions& p);

struct CriticalPointsParams {
  FieldName field;
  CriticalOptions options;
};
void describe(Schema& s, CriticalPointsParams& p);
/// A point cloud: "type" (see CriticalType; the names are in the dataset's notes), "index", "eigenvalues real", "eigenvalues imaginary",
/// "eigenvector 1" (to 2 in 2D, 3 in 3D), "gradient", "cell"; "normal" on surfaces; "part" where several parts of a
/// collection have the flow, which then is one.
DatasetPtr critical_points(const Data& in, const CriticalPointsParams& p, Context& context);
DatasetPtr critical_points_dataset(const CriticalPoints& found);
/// "7 critical points: 3 saddles, 4 centres; indices sum to 1".
std::string summary(const CriticalPoints& found);

}  // namespace sg
