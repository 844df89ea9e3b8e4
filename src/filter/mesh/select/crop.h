// SPDX-License-Identifier: Apache-2.0
// A part of a grid by indices.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct CropParams {
  std::vector<int64_t> region, stride;
};

inline void describe(Schema& s, CropParams& p) {
  s("region", p.region, "First and last point along x, y, z: i0,i1,j0,j1,k0,k1, counted from 0; default: all.").at_least(0);
  s("stride", p.stride, "Keep every n-th point: one number or one per axis.").at_least(1);
}

/// Points of a uniform, rectilinear or curvilinear grid in an index box, every n-th: crop_lattice() of data/lattice_crop.h.
/// Throws Error(usage) for other meshes, empty boxes and lists of a wrong length.
DatasetPtr crop(const DatasetPtr& in, const CropParams& p, Context& context);

}  // namespace sg
