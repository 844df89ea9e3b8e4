// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/legend/column.h"

#include <algorithm>
#include <cmath>

#include "render/annotate/legend/opacity.h"
#include "render/annotate/legend/parts.h"
#include "render/annotate/legend/ticks.h"

namespace sg {

namespace {

constexpr double widest_title = 10;
constexpr double panel_foot = 2.1;  // two lines of small letters

}  // namespace

LegendLayout layout_column(const Overlay& o, const Legend& s, const Rect& area, double whole, double font, bool nan) {
  using namespace legend;
  LegendLayout l = begun(s, font, nan);
  const TextStyle style = sized(font);
  const double line_height = o.measure("0", style).height;
  const double nan_height = nan ? 1.9 * line_height : 0;
  const bool bar = has_bar(s), panel = bar && s.volume.has_value();

  // The title stands above the bar in at most three lines, else it runs up beside the numbers.
  l.title_style.wrap = widest_title * font;
  l.title_style.break_words = false;
  if (!l.title.empty()) l.title_size = o.measure(l.title, l.title_style);
  l.title_upwards = l.title_size.lines > 3 || l.title_size.width > widest_title * font * 1.02;
  const double title_height = l.title.empty() || l.title_upwards ? 0 : l.title_size.height + 0.7 * font;
  const double glyph_height = s.glyph ? plan_glyph(o, *s.glyph, font, l) : 0;
  double height = std::min(area.height, std::max(0.66 * area.height, 15 * font));
  if (s.bar) {
    // What stands above and below the bar comes on top of its share.
    const double tip = triangle * font + 2, end = bar ? 0.5 * line_height : 0;
    const double foot = nan_height + (l.below ? tip : 0) + end;
    height = std::min(area.height, *s.bar * whole + title_height + glyph_height + (l.above ? tip : 0) + end +
                                       (panel ? std::max(foot, panel_foot * font) : foot));
  }
  if (l.title_upwards) {
    // Then it wraps to the column's height, and shrinks when even that is too little.
    l.title_style.break_words = true;
    for (l.title_style.wrap = height; l.title_style.size > 5; l.title_style.size *= 0.9) {
      l.title_size = o.measure(l.title, l.title_style);
      if (l.title_size.lines <= 2) break;
    }
  }
  const double top = std::round(area.y + 0.5 * (area.height - height));
  double y = top + title_height + glyph_height, bottom = top + height - nan_height;

  double labels = nan ? o.measure("NaN", style).width : 0;
  if (!bar) {
    l.row_height = std::ceil(1.15 * line_height);
    take_names(o, s, size_t(std::max(1.0, std::floor((bottom - y) / l.row_height))), l);
    labels = std::max(labels, l.label_width);
    bottom = std::min(bottom, y + double(l.rows.size()) * l.row_height);
  } else {
    if (l.above) y += triangle * font + 2;
    if (l.below) bottom -= triangle * font + 2;
    y += 0.5 * line_height, bottom -= 0.5 * line_height;  // for the half of a number that stands beyond the bar
  }
  if (panel) bottom = std::min(bottom, top + height - panel_foot * font);
  l.bar = {0, std::round(y), std::round(bar_width * font), std::max(2.0, std::round(bottom) - std::round(y))};
  if (bar) {
    l.ticks = legend_ticks(o, s, l.bar, false, font);
    for (const auto& t : l.ticks) labels = std::max(labels, o.measure(t.text, style).width);
  }
  l.label_width = std::ceil(labels);
  if (panel) plan_opacity(s, font, l);
  const double before = panel ? l.panel.width + std::round(panel_gap * font) : 0;
  double width = before + l.bar.width + label_gap * font + l.label_width;
  if (l.title_upwards) width += 0.5 * font + l.title_size.height;
  else width = std::max(width, l.title_size.width);
  if (s.glyph) width = std::max(width, (longest_glyph + glyph_gap + 3) * font);
  l.column = {s.place == LegendPlace::left ? area.x : area.right() - std::ceil(width), top, std::ceil(width), height};
  l.bar.x = std::round(l.column.x + before);
  l.glyph.x = l.column.x, l.glyph.y = top + title_height;
  if (panel) l.panel = {std::round(l.column.x), l.bar.y, l.panel.width, l.bar.height};
  l.nan_at = {l.bar.x, l.bar.bottom() + (l.below ? triangle * font + 2 : 0) + 0.75 * line_height};
  l.title_at = {l.column.x, l.column.y};
  if (l.title_upwards) l.title_at = {l.column.right() - l.title_size.height, l.column.y + 0.5 * (l.column.height - l.title_size.width)};
  return l;
}

}  // namespace sg
