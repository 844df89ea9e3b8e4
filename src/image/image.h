// SPDX-License-Identifier: Apache-2.0
// Image: packed 8-bit pixels, rows from the top. Frame: the planes that renderers fill.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/huge_allocator.h"

namespace sg {

/// 8-bit sRGB, straight (not premultiplied) alpha; channels 1 grey, 2 grey+alpha, 3 RGB, 4 RGBA.
struct Image {
  int width = 0, height = 0, channels = 4;
  std::vector<uint8_t> pixels;  ///< height * width * channels
  /// Text that travels in the file (PNG tEXt/iTXt): the recipe under "sightglass".
  std::vector<std::pair<std::string, std::string>> text;

  Image() = default;
  Image(int w, int h, int c) : width(w), height(h), channels(c), pixels(size_t(w) * size_t(h) * size_t(c)) {}
  uint8_t* at(int x, int y) { return &pixels[(size_t(y) * size_t(width) + size_t(x)) * size_t(channels)]; }
  const uint8_t* at(int x, int y) const { return &pixels[(size_t(y) * size_t(width) + size_t(x)) * size_t(channels)]; }
};

/// What a renderer makes: linear light, premultiplied RGBA; depth is the distance along the viewing axis (eye z), infinity
/// where nothing was hit; id is item number + 1 in the scene, 0 for background.
struct Frame {
  int width = 0, height = 0;
  Plane<float> rgba;    ///< 4 * width * height
  Plane<float> depth;   ///< width * height
  Plane<uint32_t> ids;  ///< width * height

  Frame() = default;
  /// Cleared: rgba 0, depth infinity, ids 0.
  Frame(int w, int h);
  size_t pixels() const { return size_t(width) * size_t(height); }
};

/// Linear premultiplied frame to 8-bit sRGB straight alpha. `transparent` keeps alpha (4 channels), else 3 channels.
Image to_image(const Frame& frame, bool transparent = false);

/// IEC 61966-2-1 with the standard's thresholds .0031308 and .04045.
float srgb_encode(float linear);
float srgb_decode(float encoded);

}  // namespace sg
