// SPDX-License-Identifier: Apache-2.0
// Isosurfaces: the level sets of volumes on any kind of mesh as geometry that rays meet, without a mesh of their own.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/context.h"
#include "render/trace/geometry/geometry.h"
#include "render/trace/isosurface/level_patches.h"
#include "scene/scene.h"

namespace sg::trace {

/// All volumes of a scene with the ray function isosurface: objects for GeometryOptions::more, and how they look, in the same order. The
/// number of a level is the primitive of its hits. The surface's outer side is that of smaller values, as of contours; of larger ones where
/// these are around nearly all of the volume, as of signed distances.
struct Isosurfaces {
  struct Look {
    uint32_t id = 0;            ///< item number + 1
    std::vector<Vec4f> colors;  ///< of the levels: linear, straight alpha
    /// The same at a place of the world, where colours follow another field; else empty.
    std::function<Vec4f(uint32_t level, Vec3 place)> color_at;
    std::optional<SurfaceMaterial> made_of;
    std::shared_ptr<const LevelPatches> patches;  ///< null: no pictures
  };
  std::vector<std::shared_ptr<Geometry::Object>> objects;
  std::vector<Look> looks;
};

/// Volumes in bricks are taken at the level in memory. Throws Error(usage) as for pictures without paths.
Isosurfaces isosurfaces_of(const Scene& scene, const Projection& projection, Context& context);

}  // namespace sg::trace
