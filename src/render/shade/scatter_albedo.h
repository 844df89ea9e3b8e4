// SPDX-License-Identifier: Apache-2.0
// Of what matter must be made to have a colour.
#pragma once
#include "base/vec.h"

namespace sg {

/// The share that each collision scatters, for which a half-space without a reflecting boundary returns `surface` of diffuse light, per
/// channel. Van de Hulst's fit (1980) of the reflectance, (1 - s)(1 - 0.139 s) / (1 + 1.17 s) with s^2 = (1 - a) / (1 - g a), solved for a;
/// g: mean cosine of scattering, -1 < g < 1.
Vec3f single_scatter_albedo(Vec3f surface, float g);
/// The other way round: what a half-space returns.
Vec3f surface_albedo(Vec3f scattered, float g);

}  // namespace sg
