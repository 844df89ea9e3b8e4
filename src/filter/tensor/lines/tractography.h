// SPDX-License-Identifier: Apache-2.0
// Tractography: paths of nerve fibres along the main direction of diffusion (deterministic; Basser et al. 2000, Mori et al. 1999).
#pragma once
#include "filter/tensor/tensor_field.h"
#include "filter/tensor/tensor_interpolation.h"

namespace sg {

struct TractographyParams {
  TensorSource tensors;
  std::vector<double> seeds;
  FieldName mask;
  int64_t stride = 1;
  double seed_fa = 0.25;
  double min_fa = 0.15;
  double max_angle = 30;
  double step = 0.25;
  double min_length = 0;
  std::optional<double> max_length;
  TensorInterpolation interpolation = TensorInterpolation::components;
};
void describe(Schema& s, TractographyParams& p);

/// Poly-lines along the eigenvector of the largest eigenvalue. Seeds: the points of a second input, or `seeds`, or every point of the data
/// (every stride-th along the axes of a grid) where `mask` is above 0; those with FA below seed_fa are left out. A line goes both ways
/// by Runge-Kutta steps of order 4, and ends where FA falls below min_fa, where the direction turns by more than max_angle in one cell's
/// length (steps of half a cell may turn half of it), at the border, or after max_length. Lines shorter than min_length are dropped.
/// Point fields: "direction" (u8 colours: red x, green y, blue z), "FA", "MD", "length" (from the start). Cell fields: "line length", "mean
/// FA", "line" (labels). Negative eigenvalues are counted in a warning. 2D tensors of flat meshes work alike.
DatasetPtr tractography(const DatasetPtr& in, const DatasetPtr& seeds, const TractographyParams& p, Context& ctx);
inline DatasetPtr tractography(const DatasetPtr& in, const TractographyParams& p, Context& ctx) {
  return tractography(in, nullptr, p, ctx);
}

}  // namespace sg
