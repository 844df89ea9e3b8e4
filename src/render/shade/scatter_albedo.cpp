// SPDX-License-Identifier: Apache-2.0
#include "render/shade/scatter_albedo.h"

#include <algorithm>
#include <cmath>

namespace sg {

Vec3f single_scatter_albedo(Vec3f surface, float g) {
  Vec3f scattered;
  for (int i = 0; i < 3; ++i) {
    const double a = std::clamp(double(surface[i]), 0.0, 1.0);
    // 0.139 s^2 - (1.139 + 1.17 a) s + 1 - a = 0, written so that nothing cancels near a = 1.
    const double b = 1.139 + 1.17 * a, s = 2 * (1 - a) / (b + std::sqrt(b * b - 4 * 0.139 * (1 - a)));
    scattered[i] = float((1 - s * s) / (1 - double(g) * s * s));
  }
  return scattered;
}

Vec3f surface_albedo(Vec3f scattered, float g) {
  Vec3f surface;
  for (int i = 0; i < 3; ++i) {
    const double a = std::clamp(double(scattered[i]), 0.0, 1.0), s = std::sqrt(std::max(0.0, (1 - a) / (1 - double(g) * a)));
    surface[i] = float((1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s));
  }
  return surface;
}

}  // namespace sg
