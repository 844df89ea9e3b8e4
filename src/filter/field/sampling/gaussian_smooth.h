// SPDX-License-Identifier: Apache-2.0
// gaussian_smooth: a field of a grid averaged with a Gaussian.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct GaussianSmoothParams {
  FieldName field;
  std::vector<double> sigma;
  std::string name;
};
void describe(Schema& s, GaussianSmoothParams& p);

/// The convolution of a scalar point or cell field with a Gaussian of standard deviation sigma (world lengths, one or one per axis of the
/// grid; 0 = not along it), cut off at 4 sigma, axis by axis; on uneven axes samples are weighted by the width they represent. Beyond the
/// border and where samples have no value (NaN, infinite, hidden) there is nothing: the weights of the others are divided by their sum,
/// so constants stay constant everywhere. Places without a value keep none. f32 (64-bit types f64), in place of the field unless `name` is
/// given. Uniform and rectilinear grids. Throws Error(usage) for other meshes, label fields, and an invalid sigma.
DatasetPtr gaussian_smooth(const DatasetPtr& in, const GaussianSmoothParams& p, Context& context);

}  // namespace sg
