// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/legend/parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text/round_number.h"
#include "base/text/text.h"

namespace sg::legend {

TextStyle sized(double font) {
  TextStyle style;
  style.size = font;
  return style;
}

std::string shortened(const std::string& text) {
  constexpr size_t most = 200, kept = 90;  // bytes
  if (text.size() <= most) return text;
  const auto inside = [&](size_t i) { return (uint8_t(text[i]) & 0xc0) == 0x80; };  // of a character of several bytes
  size_t head = kept, tail = text.size() - kept;
  while (head > 0 && inside(head)) --head;
  while (tail < text.size() && inside(tail)) ++tail;
  return text.substr(0, head) + "\u2026" + text.substr(tail);
}

std::string title_of(const ColorScale& s) {
  std::string title;
  for (char c : shortened(s.title)) title += c == '_' ? std::string("_\u200b") : std::string(1, c);
  if (s.unit.empty()) return title;
  std::string unit = "[";
  // No line ends within it: word joiners hold it together behind what Pango would break after.
  for (char c : shortened(s.unit))
    unit += c == ' ' ? std::string("\u00a0") : c == '/' || c == '-' ? std::string(1, c) + "\u2060" : std::string(1, c);
  unit += "]";
  return title.empty() ? unit : title + " " + unit;
}

std::string name_of_label(const ColorScale& s, size_t i) {
  return i < s.label_names.size() && !s.label_names[i].empty() ? shortened(s.label_names[i]) : short_number(s.labels[i], 8);
}

LegendLayout begun(const Legend& s, double font, bool nan) {
  LegendLayout l;
  l.place = s.place;
  l.font = font;
  l.title = title_of(s);
  l.title_style = sized(font);
  l.nan = nan;
  l.above = s.labels.empty() && s.above && s.clamp;
  l.below = s.labels.empty() && s.below && s.clamp;
  return l;
}

void take_names(const Overlay& o, const ColorScale& s, size_t room, LegendLayout& l) {
  l.swatches = s.labels.size() <= room ? s.labels.size() : room - 1;
  TextStyle name = sized(l.font);
  name.wrap = widest_name * l.font, name.ellipsize = true;
  for (size_t i = 0; i < l.swatches; ++i) l.rows.push_back(name_of_label(s, i));
  if (l.swatches < s.labels.size()) l.rows.push_back(fmt::format("\u2026 {} more", s.labels.size() - l.swatches));
  for (const std::string& row : l.rows) l.label_width = std::max(l.label_width, o.measure(row, name).width);
}

double plan_glyph(const Overlay& o, const GlyphLegend& g, double font, LegendLayout& l) {
  const double height = 1.5 * o.measure("0", sized(font)).height;
  // The largest of 1, 2, 5, 10, ... whose glyph has room, no larger than what there is.
  const double value = g.pixels > 0 && g.most > 0 ? round_below(std::min(longest_glyph * font / g.pixels, g.most)) : 0,
               size = value * g.pixels;
  if (size >= 3 && std::isfinite(size)) {
    l.glyph = {0, 0, size, height};
    l.glyph_text = typeset_number(short_number(value, 3)) + (g.unit.empty() ? "" : " " + g.unit);
  }
  return height + 0.5 * font;
}

}  // namespace sg::legend
