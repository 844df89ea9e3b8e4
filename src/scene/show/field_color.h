// SPDX-License-Identifier: Apache-2.0
// Colours of an item by a field, as its parameters request.
#pragma once
#include "base/context.h"
#include "color/legend_content.h"
#include "scene/choose/coloring.h"
#include "scene/scene.h"

namespace sg {

/// Empty for one colour.
std::optional<FieldColor> field_color(const Dataset& data, const ColoringParams& params, Context& context);

/// What the legend shows of them; empty where there is nothing to explain.
std::optional<Legend> legend_of(const std::optional<FieldColor>& color);

}  // namespace sg
