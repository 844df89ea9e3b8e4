// SPDX-License-Identifier: Apache-2.0
#include "render/composite/background.h"

#include <algorithm>

#include "base/parallel.h"

namespace sg {

void composite_background(const Scene& scene, Frame& frame) {
  if (scene.transparent) return;
  const Vec3f bottom = scene.background, top = scene.background_top.value_or(bottom);
  parallel_for(size_t(frame.height), 16, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      const float t = frame.height > 1 ? float(y) / float(frame.height - 1) : 1.0f;
      const Vec3f c = top == bottom ? bottom : lerp(top, bottom, t);
      const float linear[4] = {srgb_decode(c.x), srgb_decode(c.y), srgb_decode(c.z), 1.0f};
      float* row = &frame.rgba[y * size_t(frame.width) * 4];
      for (size_t x = 0; x < size_t(frame.width); ++x) {
        const float rest = 1.0f - row[4 * x + 3];
        for (size_t k = 0; k < 4; ++k) row[4 * x + k] += rest * linear[k];
      }
    }
  });
}

Vec3f background_of_row(const Scene& scene, const Projection& projection, int row) {
  const Vec3f bottom = scene.background, top = scene.background_top.value_or(bottom);
  const int rows = projection.rows > 0 ? projection.rows : projection.height;
  const double y = row + 0.5 - projection.middle_y() + 0.5 * rows;
  const Vec3f c = top == bottom || rows < 2 ? bottom : lerp(top, bottom, std::clamp(float((y - 0.5) / (rows - 1)), 0.0f, 1.0f));
  return {srgb_decode(c.x), srgb_decode(c.y), srgb_decode(c.z)};
}

}  // namespace sg
