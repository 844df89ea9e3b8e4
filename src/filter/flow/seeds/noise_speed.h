// SPDX-License-Identifier: Apache-2.0
// noise_speed: below which speed a measured flow is noise.
#pragma once
#include "data/dataset.h"

namespace sg {

/// 2 % of the largest speed where at least three quarters of a solid grid are slower than that and their directions are random (the
/// background of scans: directions four cells apart agree only to a mean cosine of 0.4); 0 for all other fields and meshes.
/// `velocity`: of 2 or 3 components, on the points or cells of `data`.
double noise_speed(const Dataset& data, const Field& velocity);

}  // namespace sg
