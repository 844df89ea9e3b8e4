// SPDX-License-Identifier: Apache-2.0
// Legend: what a legend shows: a colour scale and, for volumes, how much each value hides; and where it stands.
#pragma once
#include <optional>
#include <utility>

#include "color/transfer_function.h"

namespace sg {

/// The opacity of a volume over what it depends on.
struct VolumeLegend {
  OpacityCurve opacity;
  TransferDetail detail;
  ColorScale value;          ///< axis of `opacity`: that of the bar, or with detail.color_by_second another one
  std::string second_title;  ///< name of the second axis, for plane pictures
};

/// Glyphs whose size shows a value: one of them is drawn in the legend at the length it has in the middle of the picture.
struct GlyphLegend {
  double length = 0;  ///< of a glyph of value 1: world length or pixels
  bool in_pixels = false;
  bool points = true;  ///< an arrow; false: a disc as wide as that
  double most = 0;     ///< the largest value that the glyphs show
  std::string unit;
  double pixels = 0;  ///< of a glyph of value 1, set by code that knows the camera; 0: not drawn
  friend bool operator==(const GlyphLegend&, const GlyphLegend&) = default;
};

/// The side of the picture where a legend stands; at the top and the bottom its bar lies.
enum class LegendPlace { right, left, top, bottom };
constexpr auto enum_words(LegendPlace) {
  using enum LegendPlace;
  return std::array{Word{"right", right}, Word{"left", left}, Word{"top", top}, Word{"bottom", bottom}};
}

/// A colour scale is a legend without opacity.
struct Legend : ColorScale {
  Legend() = default;
  Legend(ColorScale scale) : ColorScale(std::move(scale)) {}
  Legend(ColorScale scale, VolumeLegend v) : ColorScale(std::move(scale)), volume(std::move(v)) {}
  std::optional<VolumeLegend> volume;
  std::optional<GlyphLegend> glyph;
  LegendPlace place = LegendPlace::right;
  std::optional<double> bar;  ///< length of the bar, or of a list of names, as a share of the picture's height or, where it lies, width
};

}  // namespace sg
