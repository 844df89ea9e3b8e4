// SPDX-License-Identifier: Apache-2.0
// How the built-in colour maps are made. Everything returns sRGB samples at i/(n-1).
#pragma once
#include <span>
#include <vector>

#include "base/vec.h"

namespace sg {

/// A place on a path through CIELAB: hue in degrees (counted on beyond 360 where the path goes round) and chroma.
struct HueChroma {
  double hue, chroma;
};

/// L* runs linearly from `from` to `to`; hue and chroma run through the control values along a monotone cubic whose speed
/// is chosen so that the CIEDE2000 steps are equal as far as the path allows.
std::vector<Vec3f> sequential_path(double from, double to, std::span<const HueChroma> controls, int n = 256);

/// Two hues that meet at a neutral middle; L* is the same at both ends and rounded off at the middle, where a sharp ridge would
/// draw a line that is not in the data.
std::vector<Vec3f> diverging_path(double end_lightness, double middle_lightness, double hue1, double hue2, double chroma, int n = 257);

/// Diverging map in Msh space between two saturated colours through a neutral middle (Moreland 2009).
std::vector<Vec3f> moreland_diverging(Vec3 srgb1, Vec3 srgb2, int n = 257);

/// Once round the hue circle at nearly constant lightness; first and last colour are equal.
std::vector<Vec3f> hue_circle(int n = 257);

/// Helix round the grey diagonal (Green 2011).
std::vector<Vec3f> cubehelix(double start, double rotations, double saturation, double gamma, int n = 256);

}  // namespace sg
