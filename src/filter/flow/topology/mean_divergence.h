// SPDX-License-Identifier: Apache-2.0
// The divergence of a plane flow, averaged over a disc.
#pragma once
#include <cmath>
#include <optional>

#include "base/vec.h"

namespace sg {

/// Flux through the circle about `at` over the area of its disc (Gauss). Nothing where the circle leaves the flow.
template <class Flow>
std::optional<double> mean_divergence(Flow& flow, Vec3 at, Vec3 normal, double radius) {
  constexpr int samples = 32;
  const Vec3 u = normalize(cross(std::abs(normal.x) < 0.9 ? Vec3(1, 0, 0) : Vec3(0, 1, 0), normal)), w = cross(normal, u);
  double sum = 0;
  for (int k = 0; k < samples; ++k) {
    const double angle = 2 * M_PI * k / samples;
    const Vec3 out = u * std::cos(angle) + w * std::sin(angle);
    Vec3 v;
    if (!flow(at + radius * out, 0, v)) return std::nullopt;
    sum += dot(v, out);
  }
  return 2 * sum / (samples * radius);
}

}  // namespace sg
