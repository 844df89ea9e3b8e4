// SPDX-License-Identifier: Apache-2.0
// What suits fields that nobody said anything about: those that operations make, by name; those with few extreme values, by quantiles.
#pragma once
#include <span>

#include "base/context.h"
#include "color/color_scale.h"
#include "data/dataset.h"

namespace sg {

struct FieldHabit {
  /// Which values are to be seen in a volume; fibres: the few that are not zero, as solid strands.
  enum class Shows { any, high, low, fibres } shows = Shows::any;
  bool one_sided = false;  ///< its negative values are no other kind: a sequential map
  bool two_sided = false;  ///< its signs are two kinds, however unlike their reach
  bool tailed = false;     ///< derivatives: single extreme values say little
};
/// Of "ftle", "Q", "lambda2", "swirling strength", "speed", "lic" and their like; the plain one for all others.
FieldHabit habit_of(const Field& field);

/// What a colour scale covers; an end is cut where values lie beyond it.
struct ShownRange {
  Range range;
  bool cut_low = false, cut_high = false;
};
struct FieldOf {
  const Dataset* data;
  const Field* field;
};
/// The range of one field of several datasets (magnitude where `component` is -1), without its tails: where few values lie beyond an end
/// and they reach far, the end is where they begin (tailed habits: one in 100, when the range would grow by half; others only when signed:
/// one in 200, four times). `symmetric`: the same reach on both sides of zero. Empty without finite values.
/// Of all pieces, where processes share the data.
ShownRange shown_range(std::span<const FieldOf> fields, int component, bool symmetric, const Context& context = Context());

/// Takes the range; the legend gets a triangle at cut ends, and the log a line.
void take_shown_range(const ShownRange& shown, const Range& whole, const std::string& name, ColorScale& scale, Context& context);

}  // namespace sg
