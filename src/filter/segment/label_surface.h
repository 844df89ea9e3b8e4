// SPDX-License-Identifier: Apache-2.0
// The surfaces between the labels of a label image, smooth or voxel by voxel.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct LabelSurfaceParams {
  FieldName field;
  double background = 0;
  std::vector<int64_t> labels;
  bool smooth = true;
  int iterations = 32;
  bool walls = true;
};
void describe(Schema& s, LabelSurfaceParams& p);

/// A SurfaceMesh of quads, one per pair of neighbouring samples with different labels; samples outside the image and labels that are not
/// wanted are background. Points are shared by all labels, so that neighbours share their faces and the faces around each label are
/// closed. Uniform and rectilinear grids, fields of points or cells.
///   smooth   surface nets (Gibson 1998, Frisken 2022): each corner of the voxels moves towards the mean of its neighbours on the surface,
///   and
///            back again without shrinking (Taubin 1995), but never out of the box between the eight samples around it; where three or
///            more labels meet, along the lines where they meet. Otherwise each sample is a box.
///   walls    also faces between two wanted labels; otherwise only those towards the background.
/// Cell fields: "sides" (two labels, i32 or i64; the lower wanted one first, faces look from it to the other; background for nothing), and
/// those of the samples on the first side. Time and memory do not grow with the number of labels.
/// Throws Error(usage) for other meshes and for fields that hold other than whole numbers.
DatasetPtr label_surface(const DatasetPtr& input, const LabelSurfaceParams& params, Context& context);

}  // namespace sg
