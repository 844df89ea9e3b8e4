// SPDX-License-Identifier: Apache-2.0
// Every point as a dot, or as a disc in space.
#pragma once
#include "color/legend_content.h"
#include "scene/choose/coloring.h"
#include "scene/scene.h"

namespace sg {

struct PointsShow {
  ColoringParams coloring;
  double opacity = 1, size = 4;
  bool discs = true;
};
void describe(Schema& s, PointsShow& p);

std::optional<Legend> add(Scene& scene, const DatasetPtr& data, const PointsShow& p, Context& context);

}  // namespace sg
