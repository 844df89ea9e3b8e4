// SPDX-License-Identifier: Apache-2.0
// Height as a field.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct ElevationParams {
  Vec3 direction{0, 0, 1};
  Vec3 origin{0, 0, 0};
  std::string name = "elevation";
};
inline void describe(Schema& s, ElevationParams& p) {
  s("direction", p.direction, "Direction along which height is measured; its length does not matter.");
  s("origin", p.origin, "Point of height 0.");
  s("name", p.name, "Name of the result.");
}

/// (x - origin) . direction / |direction| at each point, as a field of f32 (f64 where the points are). Throws Error(usage) for a direction
/// that is zero or not finite.
DatasetPtr elevation(const DatasetPtr& in, const ElevationParams& p, Context& ctx);

}  // namespace sg
