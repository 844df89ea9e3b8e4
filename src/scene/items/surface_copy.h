// SPDX-License-Identifier: Apache-2.0
// What a surface is a moved copy of: renderers that place geometry keep one of it for all copies.
#pragma once
#include "base/space/affine.h"
#include "data/dataset.h"

namespace sg {

/// A surface whose points are `place` of those of `original`, and whose polygons are the same ones in the same order.
struct SurfaceCopy {
  DatasetPtr original;
  Affine place;
};

}  // namespace sg
