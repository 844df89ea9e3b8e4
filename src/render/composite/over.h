// SPDX-License-Identifier: Apache-2.0
// Compositing of premultiplied linear colours from near to far.
#pragma once
#include "base/context.h"
#include "image/image.h"
#include "render/composite/fragments.h"

namespace sg {

/// What a ray has gathered so far: premultiplied colour and the share of light that still passes.
struct Gathered {
  float r = 0, g = 0, b = 0, transmittance = 1;

  /// Puts a premultiplied colour behind what is there: C += (1-A) c, then A += (1-A) a.
  void behind(float cr, float cg, float cb, float alpha) {
    r += transmittance * cr, g += transmittance * cg, b += transmittance * cb;
    transmittance *= 1 - alpha;
  }
  void behind(const float rgba[4]) { behind(rgba[0], rgba[1], rgba[2], rgba[3]); }
};

/// Each pixel's fragments over the colour in frame.rgba. Throws an internal Error when the lists do not fit the frame.
void composite_fragments(const FragmentLists& fragments, Frame& frame, const Context& context);

/// Throws an internal Error when `fragments` is neither empty nor made for a frame of this size.
void check_fragments(const FragmentLists& fragments, const Frame& frame);

}  // namespace sg
