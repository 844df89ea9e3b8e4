// SPDX-License-Identifier: Apache-2.0
// Adds the texts of a cloud of labels to a scene. Internal to scene/.
#pragma once
#include "scene/show.h"

namespace sg {

/// Throws Error(usage) for a field that has not one number per point.
std::optional<ColorScale> add(Scene& scene, const DatasetPtr& input, const LabelsShow& p, Context& context);

}  // namespace sg
