// SPDX-License-Identifier: Apache-2.0
// Variants of the classic algorithms, for tests and comparisons; layer.h's functions take the defaults.
#pragma once
#include "render/volume/methods/layer.h"

namespace sg::volume {

struct SplatOptions {
  enum class Order {
    sheets,  ///< partial splats, added up in sheets that face the viewer; the sheets are composited (Mueller, Crawfis 1998)
    whole,   ///< each kernel is composited as a whole, nearest first (Westover 1990)
  } order = Order::sheets;
  /// Classify and shade the sheets' pixels instead of the voxels (Mueller, Moeller, Crawfis 1999); the item's `classify` decides
  /// when unset. Whole kernels are always classified before.
  enum class Classify { as_item, before, after } classify = Classify::as_item;
};
Layer splat(const LayerInput& input, const SplatOptions& options);

struct SliceOptions {
  enum class Stack {
    view,  ///< planes across the viewing direction, as far apart as the item's step
    axis,  ///< the grid's own layers of samples, of the axis that is looked along most
  } stack = Stack::view;
  bool front_to_back = true;
};
Layer slices(const LayerInput& input, const SliceOptions& options);

struct ShearWarpOptions {
  double resolution = 1;  ///< pixels of the intermediate picture per voxel
};
Layer shear_warp(const LayerInput& input, const ShearWarpOptions& options);

}  // namespace sg::volume
