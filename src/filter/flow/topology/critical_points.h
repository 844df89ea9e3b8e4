// SPDX-License-Identifier: Apache-2.0
// Where a flow stands still, and how it moves about there.
#pragma once
#include <optional>
#include <vector>

#include "base/schema.h"
#include "filter/flow/flow_field.h"
#include "filter/flow/topology/linearisation.h"
#include "filter/flow/topology/plane_frame.h"

namespace sg {

struct CriticalPoint {
  Vec3 at;
  Mat3 gradient;       ///< of the interpolant; where several cells meet in the point, the mean of theirs
  Linearisation flow;  ///< in 2D: within the surface
  int index = 0;       ///< Poincare index: 1 or -1; 0 where it is not known
  int64_t cell = -1;   ///< the smallest of the cells that hold it
  double size = 0;     ///< of that cell: diagonal of its box
};

/// In order of their cells. `plane` for flat meshes of 2D cells; `normal` of curved ones per point.
struct CriticalPoints {
  int dimension = 3;
  std::optional<PlaneFrame> plane;
  std::vector<CriticalPoint> points;
  std::vector<Vec3> normal;        ///< of the surface at each point; empty for solids
  size_t spread = 0;               ///< cells with lines or areas of zeros, which are not reported
  std::optional<int> faces_index;  ///< curved surfaces: sum of the indices of all triangles (the Euler number of a closed surface)
};

struct CriticalOptions {
  double centre = 1e-3;  ///< see linearise()
  double min_speed = 0;  ///< cells that are slower than this part of the largest speed at all their points are left out
};
/// All isolated zeros of the interpolated velocity. Solids: zeros in space. Flat 2D meshes: of the part in their plane. Curved surfaces:
/// see surface_zeros.h. Zeros on faces, edges and points of several cells are one. The same for any number of threads.
/// Throws Error(usage) for meshes of lines.
CriticalPoints find_critical_points(const FlowField& flow, const CriticalOptions& options, Context& context);
/// Declares both.
void describe(Schema& s, CriticalOptions& p);

struct CriticalPointsParams {
  FieldName field;
  CriticalOptions options;
};
void describe(Schema& s, CriticalPointsParams& p);
/// A point cloud: "type" (see CriticalType; the names are in the dataset's notes), "index", "eigenvalues real", "eigenvalues imaginary",
/// "eigenvector 1" (to 2 in 2D, 3 in 3D), "gradient", "cell"; "normal" on surfaces.
DatasetPtr critical_points(const DatasetPtr& in, const CriticalPointsParams& p, Context& context);
DatasetPtr critical_points_dataset(const CriticalPoints& found);
/// "7 critical points: 3 saddles, 4 centres; indices sum to 1".
std::string summary(const CriticalPoints& found);

}  // namespace sg
