// SPDX-License-Identifier: Apache-2.0
// Connected components of a mesh.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct ComponentsParams {
  int keep = 0;
  std::optional<Vec3> at = {};
  std::vector<int64_t> points = {};
};
inline void describe(Schema& s, ComponentsParams& p) {
  s("keep", p.keep, "Keep only this many of the largest components; 0: all.").at_least(0);
  s("at", p.at, "Keep only the component with the mesh point nearest to this point.");
  s("points", p.points, "Keep only the components with these mesh points (by number).").at_least(0);
}

/// Cells that share a point are connected. Adds a cell field 'component' (i32): 0 is the component with most cells; equals in order of
/// their first cell. Hidden, refined and duplicate cells belong to none (-1) and join nothing. With keep, at or points, the other cells
/// are removed (see extract_cells). Point clouds: each point is a component. The patches of an AMR grid are connected
/// where their points lie at the same place. Throws Error(usage) for point numbers beyond the mesh. O(corners) union-find.
DatasetPtr components(const DatasetPtr& in, const ComponentsParams& p, Context& ctx);

}  // namespace sg
