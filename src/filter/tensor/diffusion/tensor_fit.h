// SPDX-License-Identifier: Apache-2.0
// Diffusion tensors from gradient images.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "filter/tensor/diffusion/diffusion_model.h"
#include "filter/tensor/diffusion/gradient_table.h"

namespace sg {

struct TensorFitParams {
  FieldName field;
  std::vector<std::string> fields;
  std::string bvals, bvecs;
  GradientFrame frame = GradientFrame::fsl;
  double b0 = 50;
  DiffusionFit method = DiffusionFit::weighted;
  FieldName mask;
  std::optional<double> min_signal;
  std::string name = "tensor";
};
void describe(Schema& s, TensorFitParams& p);

/// Fits S_i = S0 exp(-b_i g_i^T D g_i) at every point (or cell) of a field with one component a volume (gradient_images reads one from a
/// series), or of as many fields of one component. See diffusion_model.h for the methods, gradient_table.h for the gradients and frames.
/// Adds the field `name` (9 components, rows, mm^2/s, in the world of the mesh), "S0" and "residual" (root mean square, in units of the
/// signal), f32 or for 64-bit signals f64; drops the images. NaN where `mask` is not above 0, where the mean signal of the volumes with b
/// at most `b0` is below min_signal, and where a signal is NaN or fewer than seven are above zero. A note counts those, one more the
/// tensors with negative eigenvalues (none for positive). Throws Error(usage) for counts that do not fit and gradients that determine no
/// tensor.
DatasetPtr tensor_fit(const DatasetPtr& in, const TensorFitParams& p, Context& ctx);

}  // namespace sg
