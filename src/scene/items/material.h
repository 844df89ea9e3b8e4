// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sg {

/// Phong terms in linear light. Surfaces are lit on both sides.
struct Material {
  float ambient = 0.12f, diffuse = 0.88f, specular = 0.18f, power = 32;
  bool lit = true;
};

}  // namespace sg
