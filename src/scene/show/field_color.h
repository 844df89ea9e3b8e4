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

/// Lines and dots without a surface or a field: those as dark as the axes would be taken for them.
inline constexpr Vec3f lone_color{0.12f, 0.37f, 0.65f};

/// What the legend shows of them; empty where there is nothing to explain.
std::optional<Legend> legend_of(const std::optional<FieldColor>& color);

}  // namespace sg
