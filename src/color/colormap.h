// SPDX-License-Identifier: Apache-2.0
// Colour maps: t in [0,1] to sRGB. Ours are computed from a few control values; others' come from published numbers (published_maps.h).
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "base/vec.h"

namespace sg {

enum class MapKind { sequential, diverging, categorical, cyclic, unsafe };

struct Colormap {
  std::string name;
  MapKind kind = MapKind::sequential;
  std::string about;          ///< one sentence: what it is for, source
  std::vector<Vec3f> colors;  ///< sRGB-encoded 0..1; sequential maps: samples at i/(n-1), categorical: one colour per label
  /// Where the colours lie when that is not evenly: ascending from 0 to 1; of two at one place the first holds below it. Not categorical.
  std::vector<double> positions;

  /// sRGB colour at t (clamped); linear between samples, so control points are hit exactly. Categorical: colour floor(t*n).
  Vec3f at(double t) const;
  bool categorical() const { return kind == MapKind::categorical; }
};

/// The same colours from the other end.
void reverse(Colormap& map);

/// All built-in maps, in the order `sightglass colormap` lists them.
const std::vector<Colormap>& colormaps();
/// By name; NAME_r is the reverse. Throws Error(usage) with "did you mean".
Colormap find_colormap(std::string_view name);

/// Lightness analysis: CIELAB L* (D65, true sRGB curve) of n samples at i/(n-1).
struct LightnessReport {
  std::vector<double> lightness;  ///< in float, n values
  int falls_float = 0;            ///< steps of the n-1 in which L* falls, colours in float
  int falls_8bit = 0;             ///< the same after rounding the colours to 8 bits
  double lowest = 0, highest = 0;
  double steepest = 0, flattest = 0;  ///< largest and smallest CIEDE2000 step, times n-1
};
LightnessReport lightness_report(const Colormap& map, int n = 256);

}  // namespace sg
