// SPDX-License-Identifier: Apache-2.0
// The range that suits a field when nobody says one: by its look (data/field.h), and by quantiles where few values are extreme.
#pragma once
#include <span>

#include "base/context.h"
#include "color/color_scale.h"
#include "data/dataset.h"

namespace sg {

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
/// and they reach far, the end is where they begin (tailed looks: one in 100, when the range would grow by half; others only when signed:
/// one in 200, four times). `symmetric`: the same reach on both sides of zero. Empty without finite values.
/// Of all pieces, where processes share the data.
ShownRange shown_range(std::span<const FieldOf> fields, int component, bool symmetric, const Context& context = Context());

/// Takes the range; the legend gets a triangle at cut ends, and the log a line.
void take_shown_range(const ShownRange& shown, const Range& whole, const std::string& name, ColorScale& scale, Context& context);

/// Whether nine of ten values lie in the lowest tenth of a linear scale, and a logarithmic one would tell them apart: positive floats that
/// spread over more than a decade, zeros, which may be half of all, aside. False for negative values and for fields that know how they are
/// shown.
bool spans_decades(std::span<const FieldOf> fields, const Context& context = Context());

}  // namespace sg
