// SPDX-License-Identifier: Apache-2.0
// The words for a flow texture on a surface.
#pragma once
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "scene/items/surface_texture.h"

namespace sg {

struct LicShow {
  FieldName lic;
  int lic_steps = SurfaceTexture().steps;
  double lic_step = SurfaceTexture().step;
  double lic_grain = SurfaceTexture().grain;
  double lic_contrast = SurfaceTexture().contrast;
  double lic_strength = SurfaceTexture().strength;
  LicKernel lic_kernel = LicKernel::hann;
  std::optional<double> lic_phase;
};
void describe(Schema& s, LicShow& p);

/// The texture that the words request; empty without a field. Throws Error(usage) for a field that does not hold vectors.
std::optional<SurfaceTexture> surface_texture_of(const Dataset& data, const LicShow& p);

}  // namespace sg
