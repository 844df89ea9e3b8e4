// SPDX-License-Identifier: Apache-2.0
// The faces between labels and background of a label image: what a segmentation looks like, voxel by voxel.
#pragma once
#include "base/context.h"
#include "base/schema.h"
#include "data/dataset.h"

namespace sg {

struct LabelSurfaceParams {
  FieldName field;
  double background = 0;
  std::vector<int64_t> labels;
};
void describe(Schema& s, LabelSurfaceParams& p);

/// A SurfaceMesh of quads, one per pair of neighbouring samples of which one is wanted and the other is not; each sample is a
/// box centred on its point. Cell field: the label of the wanted sample, under the field's name. Uniform grids only: other
/// meshes throw Error(usage).
DatasetPtr label_surface(const DatasetPtr& input, const LabelSurfaceParams& params, Context& context);

}  // namespace sg
