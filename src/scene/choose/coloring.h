// SPDX-License-Identifier: Apache-2.0
// How values become colours: the parameters that every way to show shares, and the field that they mean.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "color/legend_content.h"
#include "data/dataset.h"

namespace sg {

/// Values that stand for things, in rising order, with a name for each or none.
struct Labels {
  std::vector<double> values;
  std::vector<std::string> names;
};

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
  bool legend = true;
  std::optional<std::string> legend_title, legend_unit;
  std::vector<double> legend_ticks;
  int legend_count = 0;
  std::string legend_format;
  LegendPlace legend_place = LegendPlace::right;
  std::optional<double> legend_bar;
  // Of all datasets that are coloured alike (shared_scale.h); no word states them.
  Labels labels;
  Range range_of;                                 ///< of their values, where `range` was chosen for them
  bool map_chosen = false;                        ///< `map` was chosen for them
  std::optional<std::array<uint64_t, 3>> beyond;  ///< count_beyond() of them, where `range` was stated

  bool states_range() const { return !range.empty() && range_of.empty(); }
  bool states_map() const { return map && !map_chosen; }
};
void describe(Schema& s, ColoringParams& p);

/// The field that colours a dataset when none is named: the result of the last operation when it varies, the bands of filled contours, its
/// scalars when they tell values, else its own colours, else the first field that tells most (telling_field.h), points before cells,
/// scalars before vectors. Null when no field varies, and where the data has materials of its own (own_materials.h) and no values.
const Field* automatic_field(const Dataset& data);
/// The same where those materials do not count.
const Field* automatic_field_without_materials(const Dataset& data);

/// The field that `params` names, else the automatic one; null for one colour and when there is none. Throws Error(usage).
const Field* wanted_field(const Dataset& data, const ColoringParams& params);

/// Components that are colours themselves.
bool is_direct_color(const Field& field);

}  // namespace sg
