// SPDX-License-Identifier: Apache-2.0
// Lines of constant width.
#pragma once
#include "color/legend_content.h"
#include "scene/choose/coloring.h"
#include "scene/scene.h"
#include "scene/show/material_words.h"

namespace sg {

struct LinesShow {
  ColoringParams coloring;
  MaterialShow material;
  std::optional<double> specular_anisotropy;
  double opacity = 1, width = 1.5;
  bool lit = false;
  double halo = 0;
  std::string halo_color = "#0d0d0f";
};
void describe(Schema& s, LinesShow& p);

/// None where the material has a colour of its own.
const Field* automatic_field(const LinesShow& p, const Dataset& d);

/// For data without lines it warns, and says how to make some.
std::optional<Legend> add(Scene& scene, const DatasetPtr& data, const LinesShow& p, Context& context);

}  // namespace sg
