// SPDX-License-Identifier: Apache-2.0
// The two ways of line integral convolution over a whole grid.
#pragma once
#include <vector>

#include "base/context.h"
#include "base/schema/enum_words.h"
#include "filter/flow/texture/line_batch.h"

namespace sg::texture {

enum class LineWeights { box, hanning, ripple };
constexpr auto enum_words(LineWeights) {
  using enum LineWeights;
  return std::array{Word{"box", box}, Word{"hanning", hanning}, Word{"ripple", ripple}};
}

/// kernel: box; hanning, (1 + cos(pi s/(L+1)))/2; ripple, that times a wave (1 + cos(2 pi ripples s/(2L+1) + 2 pi phase))/2, which moves
/// forward as the phase grows (Cabral, Leedom 1993). The box has the same weight everywhere.
Weights kernel_weights(LineWeights kernel, int steps, double phase, int ripples);

/// A line for each pixel: the weighted mean of the noise along it. Pixels without a direction are NaN. In tiles, in parallel.
void convolve_plain(const DirectionGrid& grid, const Weights& weights, float step, float* out, const Context& context);

/// Long lines through pixels that none has met yet; each gives a value to all the pixels that it passes in its tile, the means of which are
/// kept; pixels that are left over get a line of their own. Tiles are fixed and share nothing, so that threads do not matter.
void convolve_fast(const DirectionGrid& grid, const Weights& weights, float step, float* out, const Context& context);

}  // namespace sg::texture
