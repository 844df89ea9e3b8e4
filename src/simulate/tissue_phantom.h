// SPDX-License-Identifier: Apache-2.0
// A head of three tissues whose truth is known, to judge classifiers by.
#pragma once
#include "simulate/analytic_grid.h"

namespace sg {

/// Fluid, gray and white matter in a head of about 124 x 156 x 116 mm: a folded gray ribbon of 3 to 6 mm around white matter with two
/// ventricles (fluid) and two nuclei (gray), fluid outside, nothing around it.
struct TissuePhantomParams {
  GridParams grid{.size = 128, .dims = {}, .bounds = {}, .type = FieldType::f32};
  double noise = 5;
  double bias = 40;
  std::vector<double> means{0, 30, 70, 100};
  bool partial_volume = true;
  int64_t seed = 1;
};
void describe(Schema& s, TissuePhantomParams& p);

/// Point fields: "intensity" (the magnitude of a complex signal with Gaussian noise, so Rician), "truth" (u8: 0 nothing, 1 fluid, 2 gray,
/// 3 white; the largest share, the lower label when equal), "truth_fraction_1" to 3 (share of the voxel around each point, by 4 samples per
/// axis; 0 or 1 without partial_volume) and "truth_bias" (the factor on the signal). Noise is per cent of the last mean; the bias
/// runs from 1 - bias/200 to 1 + bias/200 (as in Collins et al. 1998). Throws Error(usage) unless there are four means.
DatasetPtr tissue_phantom(const TissuePhantomParams& p, Context& context);

}  // namespace sg
