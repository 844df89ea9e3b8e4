// SPDX-License-Identifier: Apache-2.0
// The light of things that glow.
#pragma once
#include "base/vec.h"

namespace sg {

/// Luminance and colour of a black body (Planck's law over the CIE 1931 observer, by the fit of Wyman, Sloan, Shirley 2013): linear sRGB,
/// which may lie below 0 outside of the gamut (below 1900 K in blue), relative to the luminance at `reference`. Temperatures in kelvin; 0
/// below 100.
Vec3 black_body(double kelvin, double reference);
/// XYZ of the same, with Y in units of its own.
Vec3 black_body_xyz(double kelvin);

}  // namespace sg
