// SPDX-License-Identifier: Apache-2.0
// profile: the values along lines as curves.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct ProfileParams {
  FieldName field = {};
};
inline void describe(Schema& s, ProfileParams& p) {
  s("field", p.field, "Point field whose values go upwards; default: the active scalar.").takes(fields::scalars);
}

/// Each line of a mesh as a curve in the plane of x and y: x is the distance from the line's first point along it, y the field's value. A
/// curve is broken where there is no value (NaN, infinity). Point fields and those of the lines are kept. Throws Error(usage) for meshes
/// without lines and for fields with several components or not at points.
DatasetPtr profile(const DatasetPtr& in, const ProfileParams& params, Context& context);

}  // namespace sg
