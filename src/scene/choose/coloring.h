// SPDX-License-Identifier: Apache-2.0
// How values become colours: the parameters that every way to show shares, and the field that they mean.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "color/color_scale.h"
#include "data/dataset.h"

namespace sg {

struct ColoringParams {
  FieldName field;
  int component = -1;
  std::optional<std::string> map;
  std::vector<double> range;
  ScaleKind scale = ScaleKind::linear;
  double linear_threshold = 0;
  std::string below, above, nan;
  bool clamp = true;
  std::string color;
};
void describe(Schema& s, ColoringParams& p);

/// The field that colours a dataset when none is named: the result of the last operation when it varies, the bands of filled contours, its
/// scalars when they vary, else its own colours, else the first field that varies, points before cells, scalars before vectors, numberings
/// last. Null when there is none.
const Field* automatic_field(const Dataset& data);

/// The field that `params` names, else the automatic one; null for one colour and when there is none. Throws Error(usage).
const Field* wanted_field(const Dataset& data, const ColoringParams& params);

/// Components that are colours themselves.
bool is_direct_color(const Field& field);

}  // namespace sg
