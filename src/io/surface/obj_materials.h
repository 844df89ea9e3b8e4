// SPDX-License-Identifier: Apache-2.0
// Materials from the libraries of OBJ files (.mtl).
#pragma once
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/context.h"
#include "base/vec.h"
#include "data/fields/material_table.h"

namespace sg {

struct ObjMaterial {
  std::optional<Vec3f> diffuse;  ///< Kd, sRGB in [0, 1]
  MaterialLook look;             ///< Kd, Ns or Pr, Pm, Ni, d or Tr, Ke, Pc, Pcr; map_Kd, map_Ke, map_Pr, map_Pm, norm
};

/// Materials by name; libraries are files beside `obj`, of which the later ones win. Numbers are sRGB as most programs write them. A
/// highlight of exponent Ns is that of a roughness of (2 / (Ns + 2))^(1/4) (Walter et al. 2007, alpha = sqrt(2 / (Ns + 2))). Other
/// statements are passed over; of what cannot be read a note tells.
std::map<std::string, ObjMaterial> read_obj_materials(const std::string& obj, std::span<const std::string_view> libraries,
                                                      Context& context);

}  // namespace sg
