// SPDX-License-Identifier: Apache-2.0
// Textures without a file.
#pragma once
#include <array>

#include "base/schema/enum_words.h"
#include "image/texture/texture.h"

namespace sg {

enum class TexturePattern { checker, noise };
constexpr auto enum_words(TexturePattern) {
  using enum TexturePattern;
  return std::array{Word{"checker", checker}, Word{"noise", noise}};
}

/// Of two colours in linear light, without seams where it repeats: checker is 2 x 2 squares, the first colour at the lower left; noise is
/// gradient noise (Perlin 1985) of five octaves, the coarsest four times across, with the colours at its least and most. The lookup of a
/// checker is sharp.
Texture pattern_texture(TexturePattern pattern, Vec3f first, Vec3f second);

}  // namespace sg
