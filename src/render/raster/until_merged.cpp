// SPDX-License-Identifier: Apache-2.0
// Stand-ins for functions of other branches; this file goes when they are here.
#include <cmath>

#include "color/color_scale.h"
#include "image/image.h"
#include "render/raster/prepared.h"
#include "render/volume/volume.h"

namespace sg {
__attribute__((weak)) float srgb_decode(float v) { return raster::linear_light(v); }
__attribute__((weak)) Vec3f Colormap::at(double t) const {
  const double x = std::clamp(t, 0.0, 1.0) * double(colors.size() - 1);
  const size_t i = std::min(size_t(x), colors.size() - 2);
  return lerp(colors[i], colors[i + 1], float(x - double(i)));
}
__attribute__((weak)) double ColorScale::position(double v) const {
  if (kind == ScaleKind::log) return v > 0 ? std::log(v / lo) / std::log(hi / lo) : NAN;
  return (v - lo) / (hi - lo);
}
__attribute__((weak)) ColorTable color_table(const ColorScale& s, int size) {
  ColorTable t;
  auto lin = [](Vec3f c, float a) { return Vec4f{raster::linear_light(c.x), raster::linear_light(c.y), raster::linear_light(c.z), a}; };
  for (int i = 0; i < size; ++i) t.linear.push_back(lin(s.map.at(i / (size - 1.0)), 1));
  t.below = lin(s.below.value_or(s.map.at(0)), s.clamp ? 1.0f : 0.0f), t.above = lin(s.above.value_or(s.map.at(1)), s.clamp ? 1.0f : 0.0f), t.nan = lin(s.nan, 1);
  return t;
}
__attribute__((weak)) void composite_volumes(const Scene&, const Projection&, const FragmentLists& f, Frame& frame, Context&) {
  if (f.empty()) return;
  for (size_t p = 0; p < frame.pixels(); ++p) {
    float sum[4] = {0, 0, 0, 0};
    for (uint32_t i = f.start[p]; i < f.start[p + 1]; ++i)
      for (int k = 0; k < 4; ++k) sum[k] += (k < 3 ? 1 - sum[3] : 1 - sum[3]) * f.fragments[i].rgba[k];
    float* q = &frame.rgba[4 * p];
    const float rest = 1 - sum[3];
    for (int k = 0; k < 4; ++k) q[k] = sum[k] + rest * q[k];
  }
}
}  // namespace sg
