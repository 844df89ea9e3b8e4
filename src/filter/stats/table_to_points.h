// SPDX-License-Identifier: Apache-2.0
// Rows of a table as points.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct TableToPointsParams {
  std::string x, y, z;
  bool line = false;
};
inline void describe(Schema& s, TableToPointsParams& p) {
  s("x", p.x, "Column of x coordinates; default: x or longitude, else the first numeric column.");
  s("y", p.y, "Column of y coordinates; default: y or latitude, else the second numeric column.");
  s("z", p.z, "Column of z coordinates; default: z, else 0.");
  s("line", p.line, "Join the rows, in their order, by a line; rows without a place break it.");
}

/// A point cloud with one point per row and every column as a point field; words by the number of their label. With `line` a SurfaceMesh of
/// poly-lines through them instead. Rows without a coordinate (NaN) are left out. Throws Error(usage) for unknown columns, columns of words
/// as coordinates, and data that is not a table.
DatasetPtr table_to_points(const Data& in, const TableToPointsParams& p, Context& ctx);

}  // namespace sg
