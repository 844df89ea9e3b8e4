// SPDX-License-Identifier: Apache-2.0
// Deformed shapes and terrain: points displaced by a field.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct WarpParams {
  FieldName field;
  std::optional<double> scale = {};
  std::optional<Vec3> direction = {};
};

inline void describe(Schema& s, WarpParams& p) {
  s("field", p.field,
    "Field of points that displaces them: vectors (2 or 3 components), or a scalar along 'direction'; default: the field named like "
    "displacement, else the active vectors, else the active scalar.")
      .takes(fields::on_points);
  s("scale", p.scale,
    "Factor of the displacement; 1 is the true shape. Default: 1 where that can be seen and does not tear the shape apart, else a round "
    "number that makes the largest displacement a tenth of the size.");
  s("direction", p.direction,
    "Where a scalar displaces to; its length does not count. Default: across flat data, else along the point normals of a surface.");
}

/// x' = x + scale u for vectors u, x' = x + scale s n for scalars s, n of unit length. Listed points keep their element type; straight
/// grids become curvilinear. Points without a finite value stay, with a warning. Fields of normals are left out: they are no longer right.
/// An automatic scale is chosen over all parts and pieces, and told. Throws Error(usage) for fields of cells, other numbers of components,
/// AMR grids, and a scalar on data that is neither flat nor has normals without `direction`.
DatasetPtr warp(const DatasetPtr& in, const WarpParams& p, Context& context);

/// The scale that warp() chooses where none is stated, over all parts of the data (data/ranks/over_all.h). Throws what it throws.
double choose_warp_scale(const Dataset& in, const WarpParams& p, const Context& context);

}  // namespace sg
