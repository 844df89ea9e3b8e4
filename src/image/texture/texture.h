// SPDX-License-Identifier: Apache-2.0
// Texture: a picture to be drawn on surfaces, with smaller and smaller copies of itself (mip maps) to look up where it is seen from afar.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "base/schema/enum_words.h"
#include "base/vec.h"
#include "image/image.h"
#include "image/linear_picture.h"

namespace sg {

/// How the numbers of a picture are meant.
enum class TexelEncoding {
  srgb,   ///< colours of a screen: decoded to linear light before anything is averaged
  linear  ///< numbers, as of roughness
};
constexpr auto enum_words(TexelEncoding) {
  using enum TexelEncoding;
  return std::array{Word{"srgb", srgb}, Word{"linear", linear}};
}

/// Texels are f32: red, green, blue times alpha, and alpha; so that averages of a picture with holes have no fringes of the colours that
/// nobody sees (Porter, Duff 1984). Level 0 is the picture, each further one has half its size, rounded down, to one texel. Each texel is
/// the mean of the area that it covers of the level below, also where that is odd (the box filter of Guthe, Heckbert 2005), so that all
/// levels have the same mean. Rows run from the bottom. A texel with a number that is not finite holds no colour: its alpha is 0.
class Texture {
 public:
  struct Level {
    int width = 0, height = 0;
    std::vector<Vec4f> texels;  ///< width * height, rows from the bottom
    const Vec4f& at(int x, int y) const { return texels[size_t(y) * size_t(width) + size_t(x)]; }
  };

  /// Premultiplied texels, rows from the bottom. Throws Error(data) for a picture without texels or of more than 2^26.
  Texture(int width, int height, std::vector<Vec4f> texels);
  /// `alpha` false: the picture's alpha is no coverage, and left out.
  static Texture of(const Image& picture, TexelEncoding encoding, bool alpha = true);
  static Texture of(const LinearPicture& picture);

  int width() const { return levels_[0].width; }
  int height() const { return levels_[0].height; }
  const std::vector<Level>& levels() const { return levels_; }
  /// Whether some texel is not opaque.
  bool translucent() const { return translucent_; }
  size_t bytes() const;

 private:
  std::vector<Level> levels_;
  bool translucent_ = false;
};

}  // namespace sg
