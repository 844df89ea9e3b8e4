// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/legend/band.h"

#include <algorithm>
#include <cmath>

#include "render/annotate/legend/opacity.h"
#include "render/annotate/legend/parts.h"
#include "render/annotate/legend/ticks.h"

namespace sg {

namespace {

constexpr double title_gap = 0.45, name_gap = 1.4, nan_gap = 1.2;  // font sizes

// What reaches beyond the two ends of the bar.
struct Ends {
  double left = 0, right = 0;
};

// Width of the swatch of NaN with its word.
double nan_width(const Overlay& o, double font) {
  return std::round(legend::bar_width * font) + legend::label_gap * font + o.measure("NaN", legend::sized(font)).width;
}

// The bar with its numbers, at x = 0, as long as the room allows; returns what reaches beyond it.
Ends place_bar(const Overlay& o, const Legend& s, double length, double room, LegendLayout& l) {
  const double font = l.font;
  l.bar = {0, 0, std::max(2.0, std::round(length)), std::round(legend::bar_width * font)};
  Ends ends;
  for (int tries = 0; tries < 2; ++tries) {
    l.ticks = legend_ticks(o, s, l.bar, true, font);
    ends = {l.below ? legend::triangle * font + 2 : 0, l.above ? legend::triangle * font + 2 : 0};
    if (l.nan) ends.right += nan_gap * font + nan_width(o, font);
    if (l.panel.width > 0) ends.right = std::max(ends.right, opacity_text_width(o, l));
    for (const auto& t : l.ticks) {
      const double half = 0.5 * o.measure(t.text, legend::sized(font)).width;
      ends.left = std::max(ends.left, half - t.row), ends.right = std::max(ends.right, t.row + half - l.bar.width);
    }
    if (l.bar.width + ends.left + ends.right <= room) break;
    l.bar.width = std::max(2.0, std::floor(room - ends.left - ends.right));
  }
  ends.left = std::ceil(ends.left), ends.right = std::ceil(ends.right);
  return ends;
}

// Names and, as the last one, the swatch of NaN, as nearly in full rows as they can be; the list begins at x = 0.
Ends place_names(const Overlay& o, const Legend& s, double length, double tallest, LegendLayout& l) {
  const double font = l.font, swatch = std::round(legend::bar_width * font);
  l.row_height = std::ceil(1.15 * o.measure("0", legend::sized(font)).height);
  legend::take_names(o, s, s.labels.size(), l);
  const auto columns = [&](size_t entries) {
    l.row_width = std::ceil(swatch + (0.6 + name_gap) * font + l.label_width);
    const auto fit = size_t(std::max(1.0, std::floor((length + name_gap * font) / l.row_width)));
    return std::clamp<size_t>(fit, 1, std::max<size_t>(entries, 1));
  };
  const size_t nans = l.nan ? 1 : 0, most = size_t(std::max(1.0, std::floor(tallest / l.row_height)));
  if (l.nan) l.label_width = std::max(l.label_width, o.measure("NaN", legend::sized(font)).width);
  l.label_width = std::ceil(l.label_width);
  l.across = columns(l.rows.size() + nans);
  if (const size_t room = most * l.across; l.rows.size() + nans > room) {
    l.rows.clear();
    legend::take_names(o, s, std::max<size_t>(1, room - std::min(room, nans)), l);
  }
  const size_t entries = l.rows.size() + nans, lines = (entries + l.across - 1) / std::max<size_t>(l.across, 1);
  if (lines > 0) l.across = (entries + lines - 1) / lines;
  l.bar = {0, 0, swatch, double(std::max<size_t>(lines, 1)) * l.row_height};
  return {0, std::ceil(double(l.across) * l.row_width - name_gap * font - swatch)};
}

}  // namespace

LegendLayout layout_band(const Overlay& o, const Legend& s, double length, double room, double tallest, double font, bool nan) {
  using namespace legend;
  LegendLayout l = begun(s, font, nan);
  const double line_height = o.measure("0", sized(font)).height;
  const bool bar = has_bar(s);
  if (bar && s.volume) plan_opacity(s, font, l);
  const double panel_height = l.panel.width;
  const Ends ends = bar ? place_bar(o, s, std::min(length, room), room, l) : place_names(o, s, std::min(length, room), tallest, l);
  const double glyph_height = s.glyph ? plan_glyph(o, *s.glyph, font, l) : 0;
  const double glyph_width = l.glyph.width > 0 ? l.glyph.width + glyph_gap * font + o.measure("= " + l.glyph_text, sized(font)).width : 0;
  // As wide as all that the title is the title of, or wider where it needs more than two lines there.
  const double core = bar ? l.bar.width : l.bar.width + ends.right;
  if (!l.title.empty())
    for (l.title_style.centred = true;; l.title_style.size *= 0.9) {
      l.title_style.wrap = std::min(room, std::max(core, 20 * font));
      l.title_size = o.measure(l.title, l.title_style);
      if (l.title_size.lines <= 2 || l.title_style.size < 5) break;
    }
  const double half = 0.5 * std::max(l.title_size.width, glyph_width), middle = 0.5 * core;
  const double left = std::ceil(std::max(ends.left, half - middle)),
               right = std::ceil(std::max(l.bar.width + ends.right, middle + half));  // of the bar's own left end
  double width = left + right, x = left;
  if (width > room)
    width = std::max(ends.left + l.bar.width + ends.right, std::min(room, width)), x = std::min(left, width - (l.bar.width + ends.right));
  x = std::round(std::max(x, ends.left));
  const auto centred = [&](double wide) { return std::clamp(x + middle - 0.5 * wide, 0.0, std::max(0.0, width - wide)); };

  double y = 0;
  l.title_at = {centred(l.title_size.width), 0};
  if (!l.title.empty()) y += l.title_size.height + title_gap * font;
  l.glyph.x = centred(glyph_width), l.glyph.y = y;
  y = std::round(y + glyph_height);
  if (panel_height > 0) l.panel = {x, y, l.bar.width, panel_height}, y = std::round(l.panel.bottom() + panel_gap * font);
  l.bar.x = x, l.bar.y = y;
  for (auto& t : l.ticks) t.row += int(x);
  y = l.bar.bottom() + (bar ? 0.5 * font + line_height : 0);
  if (bar) l.nan_at = {std::round(x + l.bar.width + (l.above ? triangle * font + 2 : 0) + nan_gap * font), l.bar.y};
  else l.nan_at = {x + double(l.rows.size() % l.across) * l.row_width, l.bar.y + double(l.rows.size() / l.across) * l.row_height};
  l.column = {0, 0, std::ceil(width), std::ceil(y)};
  return l;
}

LegendLayout moved(LegendLayout l, int dx, int dy) {
  for (Rect* r : {&l.column, &l.bar, &l.panel, &l.glyph}) r->x += dx, r->y += dy;
  for (Vec2* p : {&l.title_at, &l.nan_at}) p->x += dx, p->y += dy;
  for (auto& t : l.ticks) t.row += l.lies() ? dx : dy;
  return l;
}

}  // namespace sg
