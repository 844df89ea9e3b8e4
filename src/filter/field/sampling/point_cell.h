// SPDX-License-Identifier: Apache-2.0
// Fields from points to cells and back.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct PointToCellParams {
  std::vector<std::string> fields;
};
inline void describe(Schema& s, PointToCellParams& p) { s("fields", p.fields, "Point fields to average; default: all but ids."); }

struct CellToPointParams {
  std::vector<std::string> fields;
};
inline void describe(Schema& s, CellToPointParams& p) { s("fields", p.fields, "Cell fields to average; default: all but ids."); }

/// Adds for each point field a cell field of the same name: the mean over the cell's points. Floats keep their type, integers become
/// f32 (f64 from 32 bits on). NaN is left out of a mean; a mean of nothing is NaN. Constant fields stay constant; linear fields give
/// their value at the mean of the corners. Throws Error(usage) for unknown names.
DatasetPtr point_to_cell(const DatasetPtr& in, const PointToCellParams& p, Context& ctx);

/// Adds for each cell field a point field of the same name: the mean over the cells that use the point; hidden and refined
/// cells do not count, duplicates do, so that pieces with ghost layers agree. Points without a cell get NaN. Exact for linear fields inside
/// regular grids.
DatasetPtr cell_to_point(const DatasetPtr& in, const CellToPointParams& p, Context& ctx);

}  // namespace sg
