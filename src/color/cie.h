// SPDX-License-Identifier: Apache-2.0
// Colour science: sRGB (IEC 61966-2-1), CIE XYZ and CIELAB for D65 and the 2 degree observer, CIEDE2000.
#pragma once
#include "base/vec.h"

namespace sg {

/// sRGB transfer curve with the standard's thresholds .04045 and .0031308; odd beyond zero, unbounded above one.
double srgb_to_linear(double encoded);
double linear_to_srgb(double linear);
Vec3 srgb_to_linear(Vec3 encoded);
/// Alpha stays.
Vec4f srgb_to_linear(Vec4f encoded);
Vec3 linear_to_srgb(Vec3 linear);

/// XYZ of linear sRGB, relative to Y = 1 of white. The matrix follows from the primaries (.64,.33), (.30,.60), (.15,.06)
/// and D65 = (.95047, 1, 1.08883) (ASTM E308).
Vec3 linear_to_xyz(Vec3 linear);
Vec3 xyz_to_linear(Vec3 xyz);

/// CIELAB (L*, a*, b*) with the exact constants 216/24389 and 24389/27 (CIE 15:2018).
Vec3 xyz_to_lab(Vec3 xyz);
Vec3 lab_to_xyz(Vec3 lab);
Vec3 srgb_to_lab(Vec3 encoded);
/// May lie outside [0,1]: the colour is then out of the gamut.
Vec3 lab_to_srgb(Vec3 lab);
/// All channels within [0,1] up to `slack`.
bool in_gamut(Vec3 srgb, double slack = 1e-9);

/// CIEDE2000 colour difference of two CIELAB colours, kL = kC = kH = 1 (CIE 142:2001; Sharma, Wu, Dalal 2005).
double ciede2000(Vec3 lab1, Vec3 lab2);

}  // namespace sg
