// SPDX-License-Identifier: Apache-2.0
// Places in pictures: (0, 0) is the lower left, but in fields that have glTF's name for them, where it is the upper left.
#pragma once
#include <string_view>

#include "data/array.h"

namespace sg {

/// Whether the second coordinate of a field of this name runs downwards.
inline bool runs_down(std::string_view name) { return name.starts_with("TEXCOORD_"); }

/// Two components, f32: the second one turned round.
Array turned_round(const Array& coordinates);

}  // namespace sg
