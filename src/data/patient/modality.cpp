// SPDX-License-Identifier: Apache-2.0
#include "data/patient/modality.h"

#include <cmath>
#include <optional>

#include "base/text/text.h"

namespace sg {

Modality modality_of(const Dataset& data, const Field& field) {
  if (equal_ignoring_case(field.unit, "HU")) return Modality::ct;
  for (const auto& [key, value] : data.notes()) {
    if (!equal_ignoring_case(key, "modality")) continue;
    std::string v = to_lower(trim(value));
    if (v.starts_with("met_mod_")) v = v.substr(8);
    if (v == "ct") return Modality::ct;
    if (!v.empty() && v != "unknown" && v != "ot" && v != "other") return Modality::other;
  }
  if (data.fields().find("bval", Association::whole)) return Modality::other;  // diffusion is measured by magnetic resonance
  return Modality::unstated;
}

Range stated_window(const Dataset& data) {
  std::optional<double> center, width;
  for (const auto& [key, value] : data.notes()) {
    const std::string_view first = trim(std::string_view(value).substr(0, value.find('\\')));
    if (key == "WindowCenter") center = parse_double(first);
    if (key == "WindowWidth") width = parse_double(first);
  }
  if (!center || !width || !(*width > 1) || !std::isfinite(*center) || !std::isfinite(*width)) return {};
  return {*center - 0.5 * *width, *center + 0.5 * *width};
}

}  // namespace sg
