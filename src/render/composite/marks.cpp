// SPDX-License-Identifier: Apache-2.0
#include "render/composite/marks.h"

#include <cmath>
#include <utility>
#include <variant>

namespace sg {

Scene take_marks(Scene& scene) {
  const auto is_mark = [](const Item& item) {
    const auto* lines = std::get_if<LinesItem>(&item);
    return lines && lines->mark;
  };
  Scene marks = scene;
  marks.items.clear(), marks.shows.clear(), marks.transparent = true;
  while (!scene.items.empty() && is_mark(scene.items.back())) {
    marks.items.push_back(std::move(scene.items.back()));
    scene.items.pop_back();
  }
  return marks;
}

void put_marks(const Frame& marks, Frame& frame) {
  for (size_t i = 0; i < frame.pixels(); ++i) {
    const float* m = &marks.rgba[4 * i];
    if (!(m[3] > 0)) continue;
    float* c = &frame.rgba[4 * i];
    const bool before = std::isfinite(frame.depth[i]) && marks.depth[i] < frame.depth[i];
    const float of_frame = before ? 1 - m[3] : 1, of_mark = before ? 1 : 1 - c[3];
    for (int k = 0; k < 4; ++k) c[k] = c[k] * of_frame + m[k] * of_mark;
  }
}

}  // namespace sg
