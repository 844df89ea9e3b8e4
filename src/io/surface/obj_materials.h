// SPDX-License-Identifier: Apache-2.0
// Colours from the material libraries of OBJ files (.mtl).
#pragma once
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "base/context.h"
#include "base/vec.h"

namespace sg {

/// The diffuse colours (Kd, sRGB in [0,1]) of materials by name; libraries are files beside `obj`, of which the later ones win. Other
/// statements (Ka, Ks, maps) are passed over; of what cannot be read a note tells.
std::map<std::string, Vec3f> read_material_colors(const std::string& obj, std::span<const std::string_view> libraries, Context& context);

}  // namespace sg
