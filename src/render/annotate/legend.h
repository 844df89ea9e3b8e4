// SPDX-License-Identifier: Apache-2.0
// Legends: one column per colour scale, right side of the picture; of volumes with the opacity beside the bar.
#pragma once
#include <string>
#include <vector>

#include "color/legend_content.h"
#include "render/annotate/overlay.h"

namespace sg {

/// Where a legend's parts lie; pixels. The bar covers rows [bar.y, bar.y + bar.height), whole numbers: the first is the high end
/// and the last the low end of the scale.
struct LegendLayout {
  struct Tick {
    double value;
    std::string text;
    int row;  ///< of the picture
  };
  Rect column;
  std::string title;
  TextStyle title_style;
  TextExtent title_size;
  bool title_upwards = false;
  Rect bar;
  Rect
      panel;  ///< of volumes: left of the bar, the same rows; opacity over the value, or the plane (second axis, value). Width 0 for others
  std::string panel_left, panel_right, panel_caption;  ///< numbers at its ends, and what they are
  bool above = false, below = false;                   ///< triangles
  std::vector<Tick> ticks;                             ///< continuous scales
  std::vector<std::string> rows;                       ///< categorical scales: names, the last may say how many more there are
  size_t swatches = 0;                                 ///< of the rows, those with a colour
  double row_height = 0, label_width = 0;
  Rect glyph;  ///< above the bar: the glyph of `glyph_text`, as large as in the picture; width 0: none
  std::string glyph_text;
  double nan_y = 0;  ///< top of the NaN swatch
  bool nan = false;
  double font = 15;
};

/// Legends that fit in `area` (below the title), placed from its right edge; letters shrink until they do, and a thumbnail too
/// small for legible ones gets none.
std::vector<LegendLayout> layout_legends(const Overlay& overlay, const std::vector<Legend>& scales, const Rect& area, double font,
                                         bool nan);
/// Sum of the columns, with the margins to picture and border; 0 for none.
double legends_width(const std::vector<LegendLayout>& legends);
/// Colours go straight to the image, so that they are exact; lines and letters to the overlay.
void draw_legend(Image& image, Overlay& overlay, const Legend& scale, const LegendLayout& layout);

}  // namespace sg
