// SPDX-License-Identifier: Apache-2.0
// Presets of volumes: whole looks by name.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/show/volume.h"

namespace sg {

struct VolumePreset {
  std::string_view name, about;
};
std::span<const VolumePreset> volume_presets();

/// The preset's parameters for this field: places in Hounsfield units become values of the field, those between background and foreground
/// are read off its histogram. `reason` receives one line that says how. Throws Error(usage) for an unknown preset.
VolumeShow volume_of_preset(std::string_view name, const Dataset& data, const Field& field, int component, std::string& reason,
                            const Context& context);

}  // namespace sg
