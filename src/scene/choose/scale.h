// SPDX-License-Identifier: Apache-2.0
// Which colours suit a field.
#pragma once
#include "base/context.h"
#include "scene/choose/coloring.h"

namespace sg {

/// The colour scale for a field: map and range as asked, or chosen from the data (categorical for labels, diverging and
/// symmetric when signed about zero, else sequential; the field 'band' of filled contours: one colour a band, with its limits).
ColorScale choose_scale(const Dataset& data, const Field& field, const ColoringParams& params, Context& context);

/// Signed about zero, so that both signs get colours of their own: neither side is a mere twentieth of the other.
bool two_sided(const Field& field, const Range& range);

/// Integer values that name things: few distinct ones, in pieces. For fields of lattices, points and cells.
bool looks_like_labels(const Dataset& data, const Field& field, const Context& context = Context());

}  // namespace sg
