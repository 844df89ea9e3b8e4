// SPDX-License-Identifier: Apache-2.0
// Every point as a dot, or as a disc in space.
#pragma once
#include "color/legend_content.h"
#include "scene/choose/coloring.h"
#include "scene/scene.h"
#include "scene/show/material_words.h"

namespace sg {

struct PointsShow {
  ColoringParams coloring;
  MaterialShow material;
  double opacity = 1, size = 4;
  bool discs = true;
};
void describe(Schema& s, PointsShow& p);

/// None where the material has a colour of its own.
const Field* automatic_field(const PointsShow& p, const Dataset& d);

std::optional<Legend> add(Scene& scene, const DatasetPtr& data, const PointsShow& p, Context& context);

}  // namespace sg
