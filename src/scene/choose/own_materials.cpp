// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/own_materials.h"

#include <algorithm>

namespace sg {

bool has_own_materials(const Dataset& d) {
  const Field* numbers = material_numbers(d);
  if (!numbers) return false;
  const auto tells = [](const auto& entry) {
    const MaterialLook& l = entry.second;
    const bool pictured =
        l.base_picture.file || !l.factors.empty() || l.emission_picture.file || l.normal_picture.file || l.occlusion_picture.file;
    return pictured || l.states_matter || l.transmission > 0 || l.coat > 0 || !(l.emission == Vec3f()) || l.opacity < 1;
  };
  return std::any_of(numbers->materials->looks.begin(), numbers->materials->looks.end(), tells);
}

}  // namespace sg
