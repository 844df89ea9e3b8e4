// SPDX-License-Identifier: Apache-2.0
// Solids whose outer faces tell nothing of what is in them.
#pragma once
#include <string>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Whether the scalar that a picture would colour a solid mesh by ("" = the automatic one) is about the same all over its outer surface, 98
/// of 100 values within a fiftieth of its whole range, while inside it varies. False for surfaces, images and labels.
bool is_hidden_inside(const DatasetPtr& data, const std::string& field, Context& context);

}  // namespace sg
