// SPDX-License-Identifier: Apache-2.0
// The words for lines of equal value on a surface, drawn pixel by pixel.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/schema/schema.h"
#include "scene/items/surface_pictures.h"
#include "scene/scene.h"

namespace sg {

struct IsolineShow {
  int isolines = 0;
  std::vector<double> isoline_values;
  FieldName isoline_field;
  double isoline_width = SurfaceIsolines().width;
  std::string isoline_color = "#1a1a1a";

  bool any() const { return isolines > 0 || !isoline_values.empty(); }
};
void describe(Schema& s, IsolineShow& p);

/// The lines that the words request on `data`: of their field, else of the one that colours; empty for none. Throws Error(usage) for fields
/// that are not on points, and where there is none.
std::optional<SurfaceIsolines> isolines_of(const Dataset& data, const IsolineShow& p, const std::optional<FieldColor>& color);

}  // namespace sg
