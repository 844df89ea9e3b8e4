// SPDX-License-Identifier: Apache-2.0
// Looking a texture up: the colour of a place, filtered over what a pixel sees of it.
#pragma once
#include "base/schema/enum_words.h"
#include "image/texture/texture.h"

namespace sg {

/// What lies beyond the picture.
enum class TextureWrap { repeat, mirror, clamp };
constexpr auto enum_words(TextureWrap) {
  using enum TextureWrap;
  return std::array{Word{"repeat", repeat}, Word{"mirror", mirror}, Word{"clamp", clamp}};
}

enum class TextureFilter { nearest, bilinear, trilinear, anisotropic };
constexpr auto enum_words(TextureFilter) {
  using enum TextureFilter;
  return std::array{Word{"nearest", nearest}, Word{"bilinear", bilinear}, Word{"trilinear", trilinear}, Word{"anisotropic", anisotropic}};
}

/// A place of the picture, whose lower left corner is (0, 0) and upper right one (1, 1), and the steps from there to what the next pixel
/// to the right and the next one below see: all of it together is the pixel's footprint, a parallelogram.
struct TexturePlace {
  Vec2 at, right, down;
};

struct TextureLookup {
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
  TextureFilter filter = TextureFilter::anisotropic;
  bool sharp = false;  ///< texels are seen as squares with edges from near by, instead of blended; for patterns

  /// Linear light, premultiplied with alpha; zeros where the place is not finite.
  /// nearest: the texel there. bilinear: between the four nearest texels of the picture itself. trilinear: the same of the two levels whose
  /// texels are about as large as the footprint's longer axis, and between these. anisotropic: the same by the shorter axis, at several
  /// places evenly along the longer one, at most 16 (McCormack et al. 1999, "Feline", with even weights: the pixel is a box); the axes are
  /// those of the ellipse that a round pixel sees (Heckbert 1989). O(1).
  Vec4f operator()(const Texture& texture, const TexturePlace& place) const;
};

}  // namespace sg
