// SPDX-License-Identifier: Apache-2.0
// The same picture coarse at once, then finer and finer.
#pragma once
#include <functional>

#include "render/render.h"

namespace sg {

/// Renders one ray or sample for 8 x 8 pixels (16 x 16 in pictures of half a million pixels and more), then for half as many along each
/// side until it is the picture itself (the last frame has the bytes of render()). Each frame has the full size. `show` gets the frame and
/// how many pixels a sample covers along each side; false stops there. What does not depend on the picture's size is prepared once and kept
/// with the datasets. Returns the last frame.
Frame render_progressively(const Scene& scene, const Camera& camera, const RenderOptions& options, Context& context,
                           const std::function<bool(const Frame&, int coarseness)>& show);

}  // namespace sg
