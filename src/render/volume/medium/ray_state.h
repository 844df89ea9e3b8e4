// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "render/composite/over.h"

namespace sg::volume {

/// What a ray has gathered on its way.
struct RayState {
  Gathered sum;
  double surface = -1;  ///< t at which half of the light was gone; -1 = nowhere yet
  uint32_t surface_id = 0;
};

}  // namespace sg::volume
