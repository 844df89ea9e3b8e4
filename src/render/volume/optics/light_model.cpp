// SPDX-License-Identifier: Apache-2.0
#include "render/volume/optics/light_model.h"

#include <cmath>

namespace sg::volume {

namespace {

/// h^power by squaring for whole powers (all the usual ones), else by the library.
float power_of(float h, float power) {
  int n = int(power);
  if (float(n) != power || n < 0 || n > 4096) return std::pow(h, power);
  float result = 1;
  for (; n > 0; n >>= 1, h *= h)
    if (n & 1) result *= h;
  return result;
}

}  // namespace

Lit light_at(const LitRay& lit, Vec3f gradient, float edge, float per_scale) {
  const float square = dot(gradient, gradient);
  if (!(square > 0) || !(square < 1e30f)) return {};
  const float length = std::sqrt(square), surface = std::min(1.0f, length * edge * per_scale);
  const float side = (dot(gradient, lit.direction) > 0 ? -1.0f : 1.0f) / length;
  float diffuse = 0, specular = 0;
  for (const LitRay::One& l : lit.lights) {
    const float d = side * dot(gradient, l.light);
    if (!(d > 0)) continue;
    diffuse += l.intensity * d;
    specular += l.intensity * power_of(std::max(0.0f, side * dot(gradient, l.half)), lit.material.power);
  }
  const Material& m = lit.material;
  return {1 + surface * (m.ambient + m.diffuse * diffuse - 1), surface * (m.specular * specular)};
}

}  // namespace sg::volume
