// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "render/volume/methods/layer.h"

namespace sg::volume {

/// Draws the volumes of a scene whose method is not `ray` over the frame, each as a whole, the farther first; surfaces hide what lies
/// behind them. Where more than half of the light is taken in front of nothing, notes the item and the depth of its middle.
void draw_layers(const Scene& scene, const Projection& projection, Frame& frame, Context& context);

}  // namespace sg::volume
