// SPDX-License-Identifier: Apache-2.0
// Numbers at points, as texts of the scene.
#pragma once
#include "color/legend_content.h"
#include "scene/choose/coloring.h"
#include "scene/scene.h"

namespace sg {

struct LabelsShow {
  FieldName field;
  double size = 1;
  std::string color;
};
void describe(Schema& s, LabelsShow& p);

/// Throws Error(usage) for a field that has not one number per point.
std::optional<Legend> add(Scene& scene, const DatasetPtr& data, const LabelsShow& p, Context& context);

/// A point cloud with point fields 'value', 'angle' and 'line', as the operation line_labels makes it.
bool is_line_labels(const Dataset& data);

}  // namespace sg
