// SPDX-License-Identifier: Apache-2.0
// Colours that several datasets share: the parts of a collection, the steps of a film.
#pragma once
#include <array>
#include <span>

#include "scene/choose/coloring.h"
#include "scene/choose/shown_range.h"

namespace sg {

/// What choose_scale() does for one dataset, decided once for all: fills in labels, or map, range and the colours beyond cut ends, where
/// not stated. `fields`: the same field of each dataset that has it, at least one. False, and nothing changed, where every dataset comes to
/// the same by itself.
bool share_scale(std::span<const FieldOf> fields, ColoringParams& p, const Context& context = Context());

/// The same by the range of all, for datasets that are not in memory together; no tails are cut. `one`: the field in one of them.
bool share_range(const Field& one, Range all, ColoringParams& p);

/// Below the range, above it, and all that are not NaN, of all these fields together.
std::array<uint64_t, 3> count_beyond(std::span<const FieldOf> fields, const ColoringParams& p);
/// Whether it is told: for who states colours for what lies beyond a stated range.
bool tells_beyond(const ColoringParams& p);
/// The note of these counts, which are added up over all processes.
void tell_beyond(const Field& field, std::array<uint64_t, 3> counts, const Context& context);

}  // namespace sg
