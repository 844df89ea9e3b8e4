// SPDX-License-Identifier: Apache-2.0
// The small part of a large domain in which something happens, such as the wing in its far field.
#pragma once
#include <optional>
#include <span>

#include "scene/choose/shown_range.h"

namespace sg {

/// The box of most of the points, with a margin, where it is short beside the whole along two axes at least and the field of points hardly
/// varies beyond it; nothing else.
std::optional<Box3> crowded_box(std::span<const FieldOf> fields);

}  // namespace sg
