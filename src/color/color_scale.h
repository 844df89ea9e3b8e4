// SPDX-License-Identifier: Apache-2.0
// ColorScale: from a value to a colour, with everything a legend must show. OpacityCurve: from a value to an opacity.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/schema/enum_words.h"
#include "base/vec.h"
#include "color/colormap.h"

namespace sg {

enum class ScaleKind { linear, log, symlog };
constexpr auto enum_words(ScaleKind) {
  return std::array{Word{"linear", ScaleKind::linear}, Word{"log", ScaleKind::log}, Word{"symlog", ScaleKind::symlog}};
}

struct ColorScale {
  Colormap map;
  double lo = 0, hi = 1;
  ScaleKind kind = ScaleKind::linear;
  double linear_threshold = 0;           ///< symlog: linear within +-threshold; 0 = a thousandth of the larger end
  std::optional<Vec3f> below, above;     ///< sRGB; empty = the end colour (clamped)
  Vec3f nan{0.6f, 0.6f, 0.6f};           ///< sRGB
  bool clamp = true;                     ///< false: values out of range are not drawn (transparent)
  std::vector<double> labels;            ///< categorical: the values, in order; a value takes the colour of its place
  std::vector<std::string> label_names;  ///< categorical: text per label, may be empty
  /// With labels that represent neighbouring bands of values: their borders, one more than labels; the legend shows these.
  std::vector<double> limits;
  std::string title, unit;
  std::vector<double> ticks;  ///< numbers beside the legend's bar; none: round ones
  int tick_count = 0;         ///< so many; 0: as many as suit the bar
  std::string number_format;  ///< of these numbers, as formatted_number() takes it; "": the shortest that tells them apart

  /// Position on the map, may lie outside [0,1] (below, above), NaN for NaN; on a log scale values <= 0 lie beyond the smaller end.
  /// With labels: the middle of the label's band, NaN for any other value (up to rounding to float).
  double position(double value) const;
  /// The value drawn at a position (inverse of position).
  double value_at(double t) const;
  /// sRGB colour with alpha 1, or alpha 0 when out of range and not clamped.
  Vec4f color(double value) const;
  /// The same from a position; NaN is the NaN colour.
  Vec4f color_at(double position) const;
};

/// A table of colours in linear light for renderers: `size` samples over [0,1] of position plus below, above and nan.
struct ColorTable {
  std::vector<Vec4f> linear;  ///< linear RGB, straight alpha
  Vec4f below, above, nan;
  const Vec4f& at(double position) const {
    if (!(position == position)) return nan;
    if (position < 0) return below;
    if (position > 1) return above;
    return linear[size_t(position * double(linear.size() - 1) + 0.5)];
  }
};
/// At least `size` samples (more when labels need them). Throws Error(usage) for a log scale whose range is not positive.
ColorTable color_table(const ColorScale& scale, int size = 4096);

/// Values, ascending, at which the colour, or whether there is one, jumps, or bends so sharply that evenly spaced samples would miss it:
/// stops, borders of bands, the ends of the scale. Narrow ramps between stops have additional ones in between. None for labels.
std::vector<double> color_knots(const ColorScale& scale);

/// Piecewise-linear opacity over values: sorted (value, opacity) points; constant beyond the ends.
/// Opacity is per `unit` of length: a segment of length h has alpha = 1 - (1 - opacity)^(h/unit).
struct OpacityCurve {
  std::vector<Vec2> points{{0, 0}, {1, 1}};
  double at(double value) const;
  /// Largest opacity over [a, b].
  double most(double a, double b) const;
};

/// "0:0,0.3:0.1,1:0.8": positions, 0 at the value lo and 1 at hi (lo 0 and hi 1: values), and opacities in [0,1]; a single
/// number is a constant opacity. @v is the value v itself. Positions ascend; two points at one make a step. Throws Error(usage).
OpacityCurve parse_opacity(const std::string& text, double lo, double hi);

struct TickLabel {
  double value;
  std::string text;
};
/// About `wanted` round values in [lo, hi] with texts that distinguish them; powers of ten on a log scale.
std::vector<TickLabel> nice_ticks(double lo, double hi, int wanted, ScaleKind kind = ScaleKind::linear, double linear_threshold = 0);

/// The shortest texts (up to 8 digits) that resolve the values to a hundredth of their smallest distance.
std::vector<std::string> distinct_texts(const std::vector<double>& values);

}  // namespace sg
