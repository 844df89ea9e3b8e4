// SPDX-License-Identifier: Apache-2.0
// Up is where a shape stands.
#include <fmt/core.h>

#include "data/patient/patient_frame.h"
#include "io/y_up.h"
#include "scene/choose/view/upright.h"
#include "scene/look/look_parts.h"

namespace sg {

std::string stand_upright(std::span<const DatasetPtr> parts, const std::string& extension, CameraDefaults& camera) {
  constexpr double clear = 0.2, slight = 0.25;  // feet below a body; so much less the flank of what lies on its side
  std::vector<const SurfaceMesh*> surfaces;
  Box3 box;
  for (const DatasetPtr& d : parts) {
    const auto* mesh = d->as<SurfaceMesh>();
    if (!mesh || in_patient_frame(*d) || automatic_field(*d)) return "";
    surfaces.push_back(mesh), box.add(d->bounds());
  }
  if (extension.empty() || states_up(extension) || camera.parallel || surfaces.empty()) return "";
  const bool y_up = y_points_up(extension);
  const int usual = y_up ? 1 : 2, other = y_up ? 2 : 1;
  const double stands = stability(surfaces, usual);
  if (stands >= clear) return "";
  const auto name = [](int axis) { return axis == 1 ? "y" : "z"; };
  const double stands_otherwise = stability(surfaces, other);
  if (stands_otherwise <= stands) return "";
  if (stands_otherwise < clear || stands > slight * stands_otherwise)
    return fmt::format("up is {}, as in most files of this kind (--camera up={} is the other)", name(usual), y_up ? "0,0,1" : "0,1,0");
  camera = view_with_up(box, !y_up);
  return fmt::format("up is {}, along which it stands (--camera up={} is the other)", name(other), y_up ? "0,1,0" : "0,0,1");
}

}  // namespace sg
