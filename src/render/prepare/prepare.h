// SPDX-License-Identifier: Apache-2.0
// From a scene to flat arrays, once for all cameras.
#pragma once
#include <memory>

#include "base/context.h"
#include "scene/scene.h"

namespace sg {

/// Triangles, normals and colours of a scene, ready to be drawn from any camera. Shares the arrays of the datasets where their
/// layout permits (packed f32 positions, 32-bit triangles).
class PreparedScene;
using PreparedScenePtr = std::shared_ptr<const PreparedScene>;
/// Throws Error(usage) for an unknown field and for items whose mesh is of the wrong kind.
PreparedScenePtr prepare_scene(const Scene& scene, Context& context);

}  // namespace sg
