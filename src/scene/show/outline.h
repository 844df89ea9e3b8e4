// SPDX-License-Identifier: Apache-2.0
// The box around the data.
#pragma once
#include "color/legend_content.h"
#include "scene/choose/coloring.h"
#include "scene/scene.h"

namespace sg {

struct OutlineShow {
  std::string color = "#707078";
  double width = 1.2;
};
void describe(Schema& s, OutlineShow& p);

/// Of a uniform grid its own box, which may be turned; of others the bounds.
std::optional<Legend> add(Scene& scene, const DatasetPtr& data, const OutlineShow& p, Context& context);

}  // namespace sg
