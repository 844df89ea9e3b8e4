// SPDX-License-Identifier: Apache-2.0
// Scenes ready to be traced.
#pragma once
#include "render/raster/raster_support.h"
#include "render/trace/geometry/geometry.h"
#include "trace_support.h"

namespace sg::trace::test {

inline Geometry geometry_of(const Scene& scene, const GeometryOptions& options = {}) {
  Context context;
  return Geometry::make(*prepare_scene(scene, context), options, context);
}
inline Geometry geometry_of(Item item, const GeometryOptions& options = {}) {
  Scene scene;
  scene.items.push_back(std::move(item));
  return geometry_of(scene, options);
}

}  // namespace sg::trace::test
