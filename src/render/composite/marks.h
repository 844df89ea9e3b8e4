// SPDX-License-Identifier: Apache-2.0
// Lines that belong to the picture and not to the data (LinesItem::mark), in pictures by paths of light: drawn by themselves.
#pragma once
#include "image/image.h"
#include "scene/scene.h"

namespace sg {

/// Takes the marks out of the scene into one of their own, which is transparent; they are its last items, so that all others keep their
/// numbers. Empty where there are none.
Scene take_marks(Scene& scene);

/// `marks` in front of what is farther and behind what is nearer or has no depth, as far as that is transparent. Both premultiplied.
void put_marks(const Frame& marks, Frame& frame);

/// What is seen of `behind` through the marks at a pixel.
inline Vec3f seen_behind(const Frame& marks, size_t pixel, Vec3f behind) {
  const float* m = &marks.rgba[4 * pixel];
  return Vec3f{m[0], m[1], m[2]} + behind * (1 - m[3]);
}

}  // namespace sg
