// SPDX-License-Identifier: Apache-2.0
// A mesh without leftovers.
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
  s("tolerance", p.tolerance, "Points up to this far apart become one; 0: only equal ones.").at_least(0).unit("length");
  s("merge", p.merge, "Makes one of points at the same place.");
  s("duplicates", p.duplicates, "Drops cells of the same points as an earlier cell.");
  s("degenerate", p.degenerate, "Drops cells with too few different points, and repeated points of polygons and lines.");
  s("flat", p.flat, "Drops also polygons without area and solids without volume, though their neighbours lean on them.");
}

/// merge_points, then no degenerate cells, no doubled cells (in whatever order they list their points; the first stays) and no unused
/// points. Fields are carried; the log tells what went. Grids have nothing to clean and come back as they are; point clouds are merged;
/// AMR is refused (Error(usage)).
DatasetPtr clean(const DatasetPtr& in, const CleanParams& p, Context& ctx);

}  // namespace sg
