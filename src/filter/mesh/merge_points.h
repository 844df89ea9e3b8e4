// SPDX-License-Identifier: Apache-2.0
// Points at the same place become one.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct MergePointsParams {
  double tolerance = 0;
};
inline void describe(Schema& s, MergePointsParams& p) {
  s("tolerance", p.tolerance, "Merge points up to this far apart; 0: only equal ones.").at_least(0).unit("length");
}

/// Each point is replaced by the first point (in input order) that stays and lies within the tolerance; those that stay keep their
/// place, their fields and their order. Cells that fall together (fewer distinct points than a cell of their dimension needs) are
/// removed, with a note. Grids have no double points and come back as they are; AMR is refused. O(n log n) for 0, else O(n)
/// expected.
DatasetPtr merge_points(const DatasetPtr& in, const MergePointsParams& p, Context& ctx);

}  // namespace sg
