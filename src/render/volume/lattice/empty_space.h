// SPDX-License-Identifier: Apache-2.0
// Which bricks draw something, and how far it is to them: made again whenever a transfer function changes, so it must be quick.
#pragma once
#include "index/minmax_bricks.h"
#include "render/volume/optics/transfer.h"

namespace sg::volume {

/// For each brick the Chebyshev distance in bricks to the nearest one that draws something: 0 for those themselves; d > 0 says that
/// all bricks nearer than d are empty. At most 63. Three bytes follow the last one, so that any of them can be read as a word.
std::vector<uint8_t> distance_to_drawn(const MinMaxBricks& bricks, const Transfer& transfer, bool& any_empty);

}  // namespace sg::volume
