// SPDX-License-Identifier: Apache-2.0
// Removes unused points, degenerate and duplicate cells.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct CleanParams {
  double tolerance = 0;
  bool merge = true, duplicates = true, degenerate = true, flat = false;
};
inline void describe(Schema& s, CleanParams& p) {
  s("tolerance", p.tolerance, "Merge points up to this far apart; 0: only equal ones.").at_least(0).unit("length");
  s("merge", p.merge, "Merge points at the same position.");
  s("duplicates", p.duplicates, "Drop cells with the same points as an earlier cell.");
  s("degenerate", p.degenerate, "Drop cells with too few distinct points, and repeated points of polygons and lines.");
  s("flat", p.flat, "Also drop polygons without area and solids without volume, even if neighbours depend on them.");
}

/// merge_points, then no degenerate cells, no duplicate cells (in whatever order they list their points; the first stays) and no unused
/// points. Fields are carried; the log reports what was removed. Grids have nothing to clean and come back as they are; point clouds are
/// merged; AMR is refused (Error(usage)).
DatasetPtr clean(const DatasetPtr& in, const CleanParams& p, Context& ctx);

}  // namespace sg
