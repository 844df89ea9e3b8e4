// SPDX-License-Identifier: Apache-2.0
// How the noise along a line of a surface's texture is weighted.
#pragma once
#include "base/schema/enum_words.h"

namespace sg {

enum class LineFade {
  hann,  ///< 1 + cos: soft ends
  box,   ///< all alike: the longest correlation for the number of steps
};
constexpr auto enum_words(LineFade) { return std::array{Word{"hann", LineFade::hann}, Word{"box", LineFade::box}}; }

}  // namespace sg
