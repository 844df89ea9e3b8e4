// SPDX-License-Identifier: Apache-2.0
// Flat shapes drawn out into solid ones.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct ExtrudeParams {
  std::optional<Vec3> direction = {};
  std::optional<double> length = {};
  bool caps = true;
};
inline void describe(Schema& s, ExtrudeParams& p) {
  s("direction", p.direction, "Direction to draw along; default: across a flat mesh, else z.");
  s("length", p.length, "How far; default: a tenth of the mesh's size.").unit("@length");
  s("caps", p.caps, "Close the ends with the polygons and their copies; false: walls alone.");
}

/// Surfaces: each border of the polygons becomes a wall of quadrilaterals, and with `caps` the polygons close both ends, all facing
/// outwards. Lines become walls, vertices lines. Points are listed twice, the drawn-out ones behind the others; their fields are copied, a
/// wall has the cell fields of what it comes from, and 'original_cell' tells that one. Throws Error(usage) for strips, and a direction or a
/// length of zero. O(cells).
DatasetPtr extrude(const DatasetPtr& in, const ExtrudeParams& p, Context& ctx);

}  // namespace sg
