// SPDX-License-Identifier: Apache-2.0
// Volume ray caster: integrates each ray through the volumes up to the opaque depth, mixing in translucent fragments in order.
#pragma once
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "image/image.h"
#include "render/composite/fragments.h"
#include "scene/scene.h"

namespace sg {

/// The frame holds the opaque picture (rgba, depth); on return rgba is fragments and volumes over it (premultiplied; no
/// background yet). Scenes without volumes just get their fragments composited.
/// `coarser` as in RenderOptions.
/// With `wanted`, one flag per tile of 16 x 16 pixels (rows of ceil(width/16)), the other tiles may be left without volumes.
void composite_volumes(const Scene& scene, const Projection& projection, const FragmentLists& fragments, Frame& frame, Context& context,
                       const std::vector<uint8_t>* wanted = nullptr, double coarser = 1);

}  // namespace sg
