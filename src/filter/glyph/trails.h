// SPDX-License-Identifier: Apache-2.0
// Trails: where particles were just before a time, for moving pictures like weather maps.
#pragma once
#include "base/context.h"
#include "base/schema/color_params.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct TrailsParams {
  std::optional<double> time = {};
  double length = 0;
  FieldName field = {};
  bool heads = true;
  std::vector<double> color{0.09, 0.1, 0.16};
};
inline void describe(Schema& s, TrailsParams& p) {
  s("time", p.time, "Time shown; default: the latest at which half of the lines still run.").unit("@field");
  s("length", p.length, "Duration of a trail before that time; 0: a tenth of the duration of most lines.").unit("@field").at_least(0);
  s("field", p.field, "Point field of times that increase along each line; default: 'time', 'integration time' or 'IntegrationTime'.")
      .takes(fields::point_scalars);
  s("color", p.color, "Red, green and blue (0 to 1) of the field 'trail'.").unit(color_unit).range(0, 1);
  s("heads", p.heads, "Add a vertex at the current position of each particle.");
}

/// The part of each poly-line with times in [time - length, time], cut exactly at both ends (fields interpolated), as a SurfaceMesh of
/// lines (and vertices: the heads) with the point fields 'age' (f32): 0 at the moment, 1 at the end of the trail, and 'trail' (u8 x 4, role
/// colors): the colour, fading with age. Lines may run backward in time. Cell fields are carried. Throws Error(usage) without lines or a
/// field of times.
DatasetPtr trails(const DatasetPtr& data, const TrailsParams& p, Context& context);

}  // namespace sg
