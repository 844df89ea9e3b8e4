// SPDX-License-Identifier: Apache-2.0
// Which colours suit a field.
#pragma once
#include <span>

#include "base/context.h"
#include "scene/choose/coloring.h"
#include "scene/choose/shown_range.h"

namespace sg {

/// The colour scale for a field: map and range as asked, or chosen from the data (categorical for labels, diverging and
/// symmetric when signed about zero, else sequential; the field 'band' of filled contours: one colour a band, with its limits).
ColorScale choose_scale(const Dataset& data, const Field& field, const ColoringParams& params, Context& context);

/// Signed about zero, so that both signs get colours of their own: neither side is a mere twentieth of the other.
bool two_sided(const Field& field, const Range& range);

/// Is it what a scanner measured, and nothing computed from that?
bool is_scanned(const Dataset& data, const Field& field);

/// The map of values of one sign: grey for what a scanner measured, as scans are read.
std::string_view sequential_map(const Dataset& data, const Field& field);

/// Integer values that name things: few distinct ones, in pieces. For fields of lattices, points and cells.
bool looks_like_labels(const Dataset& data, const Field& field, const Context& context = Context());

/// The labels of one field in several datasets, with the names that any of them knows. `categorical`: its values are labels for certain,
/// else only where they look like some in each dataset or are the same all over it; no values when they are none.
Labels labels_of(std::span<const FieldOf> fields, bool categorical, const Context& context = Context());

}  // namespace sg
