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
  bool vectors = true;
};
inline void describe(Schema& s, TableToPointsParams& p) {
  s("x", p.x, "Column of x coordinates; default: position_x, x, longitude or Points_0, else the first numeric column.");
  s("y", p.y, "Column of y coordinates; default: position_y, y, latitude or Points_1, else the second numeric column.");
  s("z", p.z, "Column of z coordinates; default: position_z, z or Points_2, else 0.");
  s("line", p.line, "Join the rows, in their order, by a line; rows without a place break it.");
  s("vectors", p.vectors, "Columns NAME_x, NAME_y and NAME_z (or the first two) become one vector field NAME.");
}

/// A point cloud with one point per row and every column as a point field, those of a vector as one (vector_columns.h); words by the
/// number of their label. With `line` a SurfaceMesh of
/// poly-lines through them instead. Rows without a coordinate (NaN) are left out. Throws Error(usage) for unknown columns, columns of words
/// as coordinates, and data that is not a table.
DatasetPtr table_to_points(const Data& in, const TableToPointsParams& p, Context& ctx);

}  // namespace sg
