// SPDX-License-Identifier: Apache-2.0
// SurfaceShadow: where opaque surfaces hide a distant lamp.
#pragma once
#include <memory>
#include <vector>

#include "base/context.h"
#include "scene/camera.h"
#include "scene/scene.h"

namespace sg::volume {

/// The depth of the nearest opaque surface or glyph as the lamp sees it, on a square picture of the receivers (Williams 1978), drawn by the
/// rasterizer. A place is lit by the share of the four pixels around it whose surface does not lie before it, bilinearly: edges of
/// shadows are one pixel of that picture soft. Surfaces as near as 2 pixels before a place do not count.
class SurfaceShadow {
 public:
  /// `towards` is the direction to the lamp; `receivers` the box in which places are asked for.
  SurfaceShadow(const Scene& scene, const Box3& receivers, Vec3 towards, int side, Context& context);
  float lit(Vec3 place) const;
  bool empty() const { return depth_.empty(); }  ///< nothing casts a shadow

 private:
  Projection from_lamp_;
  double hair_ = 0;
  std::vector<float> depth_;
  std::vector<DatasetPtr> casters_;  // so that their addresses are not reused while this is kept
};

/// Items of the scene that hide light.
bool casts_shadow(const Item& item);
/// Kept with `memo_of`, for the frames and bands of a picture. Null when nothing casts a shadow.
std::shared_ptr<const SurfaceShadow> surface_shadow(const Dataset& memo_of, const Scene& scene, const Box3& receivers, Vec3 towards,
                                                    size_t lamps, Context& context);

}  // namespace sg::volume
