// SPDX-License-Identifier: Apache-2.0
// Legends: one column per colour scale at the left or right side of the picture, or one lying bar at its top or bottom; of volumes with the
// opacity beside the bar.
#pragma once
#include <string>
#include <vector>

#include "color/legend_content.h"
#include "render/annotate/overlay/overlay.h"

namespace sg {

/// Where a legend's parts lie; pixels. The bar covers whole pixels. Where it stands its first row is the high end of the scale and its last
/// row the low end; where it lies its first column is the low end and its last column the high end.
struct LegendLayout {
  struct Tick {
    double value;
    std::string text;
    int row;  ///< of the picture; where the bar lies, its column
  };
  LegendPlace place = LegendPlace::right;
  Rect column;  ///< of all its parts
  std::string title;
  TextStyle title_style;
  TextExtent title_size;
  bool title_upwards = false;
  Vec2 title_at;  ///< its upper left corner, as it is drawn
  Rect bar;
  /// Of volumes: left of the bar, the same rows, or above a lying one, the same columns; opacity over the value, or the plane (second axis,
  /// value). Width 0 for others.
  Rect panel;
  std::string panel_left, panel_right, panel_caption;  ///< numbers at its ends (lying: the lower, the upper one), and what they are
  bool above = false, below = false;                   ///< triangles
  std::vector<Tick> ticks;                             ///< continuous scales
  std::vector<std::string> rows;                       ///< categorical scales: names, the last may say how many more there are
  size_t swatches = 0;                                 ///< of the rows, those with a colour
  size_t across = 1;                                   ///< so many rows stand side by side, the first ones at the top
  double row_height = 0, label_width = 0, row_width = 0;
  Rect glyph;  ///< above the bar: the glyph of `glyph_text`, as large as in the picture; width 0: none
  std::string glyph_text;
  Vec2 nan_at;  ///< upper left corner of the NaN swatch
  bool nan = false;
  double font = 15;

  bool lies() const { return place == LegendPlace::top || place == LegendPlace::bottom; }
};

/// Legends that fit in `area` (below the title, of which their bars take shares), each at its side; letters shrink until they do, and a
/// thumbnail too small for legible ones gets none. In the order of `scales`.
std::vector<LegendLayout> layout_legends(const Overlay& overlay, const std::vector<Legend>& scales, const Rect& area, double font,
                                         bool nan);
/// What the legends at one side take of the picture's width or, at the top and the bottom, height: with the margins to picture and border;
/// 0 for none.
double legends_width(const std::vector<LegendLayout>& legends, LegendPlace side = LegendPlace::right);
/// Colours go straight to the image, so that they are exact; lines and letters to the overlay.
void draw_legend(Image& image, Overlay& overlay, const Legend& scale, const LegendLayout& layout);

}  // namespace sg
