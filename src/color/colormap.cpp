// SPDX-License-Identifier: Apache-2.0
#include "color/colormap.h"

namespace sg {

Vec3f Colormap::at(double t) const {
  const size_t n = colors.size();
  if (n == 0) return {0, 0, 0};
  if (!(t > 0)) return colors.front();
  if (t >= 1) return colors.back();
  if (categorical()) return colors[std::min(n - 1, size_t(t * double(n)))];
  const double x = t * double(n - 1);
  const size_t i = std::min(size_t(x), n - 1);
  if (i + 1 == n) return colors.back();
  return lerp(colors[i], colors[i + 1], float(x - double(i)));
}

}  // namespace sg
