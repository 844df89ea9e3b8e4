// SPDX-License-Identifier: Apache-2.0
// The volumes of a collection's parts as one: the same look, and rays that see all of them together.
#pragma once
#include <cstdint>
#include <span>

#include "scene/scene.h"

namespace sg {

/// Gives the volumes among `items` one group (not 0) and the look of `model`, one of them: colours, opacity, second axis, levels, and the
/// length to which opacity refers (1/100 of the diagonal of all parts where none is stated). Ranges of what is collected along rays (sum,
/// distance, length) grow with the diagonal. Each keeps its data, field and clipping.
void join_volumes(std::span<Item> items, const VolumeItem& model, uint32_t group);

}  // namespace sg
