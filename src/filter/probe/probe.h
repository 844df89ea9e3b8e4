// SPDX-License-Identifier: Apache-2.0
// probe: the fields of one mesh at the points of another, or at given points.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct ProbeParams {
  bool keep_fields = true;
};
inline void describe(Schema& s, ProbeParams& p) {
  s("keep_fields", p.keep_fields, "Keep the first input's own fields if the second has none of the same name.");
}

/// The mesh of `points` with the fields of `source` at its points, linear in each cell (its shape functions), and the u8 point field
/// "valid": 1 where a cell of `source` holds the point (CellLocator::find), else the fields are NaN (integers 0). Point fields of
/// integers become f32 (64-bit ones f64); cell fields become point fields with the value of the cell. A point cloud as source gives
/// the value of its nearest point. O((cells + points) log cells).
DatasetPtr probe(const DatasetPtr& points, const DatasetPtr& source, const ProbeParams& params, Context& context);

struct ProbeAtParams {
  std::vector<double> points;
  std::optional<Vec3> from, to;
  int64_t count = 100;
};
inline void describe(Schema& s, ProbeAtParams& p) {
  s("points", p.points, "Points as x,y,z,x,y,z,...");
  s("from", p.from, "First end of a line.");
  s("to", p.to, "Other end of the line.");
  s("count", p.count, "Number of points on the line, both ends included.").range(2, 1e9);
}

/// The fields of `source` at given points (a PointCloud) or along a straight line (a SurfaceMesh of one poly-line, with the point field
/// "distance" from its start), else as probe(). Throws Error(usage) unless there is either a list of points or a line.
DatasetPtr probe_at(const DatasetPtr& source, const ProbeAtParams& params, Context& context);

}  // namespace sg
