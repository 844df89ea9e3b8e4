// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/legend.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text/round_number.h"
#include "base/text/text.h"
#include "render/annotate/legend_opacity.h"

namespace sg {
namespace {

constexpr double margin = 1.1;  // all in font sizes
constexpr double column_gap = 1.5;
constexpr double bar_width = 1.3;
constexpr double label_gap = 0.75;  // from the bar to its numbers
constexpr double triangle = 1.0;
constexpr double widest_title = 10, widest_name = 12;
constexpr double panel_gap = 0.3, panel_foot = 2.1;  // foot: two lines of small letters

// A name that no legend has room for keeps its beginning and its end; laying it out takes the square of its length.
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
  for (char c : shortened(s.title)) title += c == '_' ? std::string("_\u200b") : std::string(1, c);  // names may break after an underscore
  if (s.unit.empty()) return title;
  std::string unit = "[";
  for (char c : shortened(s.unit)) unit += c == ' ' ? std::string("\u00a0") : std::string(1, c);  // stays on one line
  unit += "]";
  return title.empty() ? unit : title + " " + unit;
}

std::string name_of_label(const ColorScale& s, size_t i) {
  return i < s.label_names.size() && !s.label_names[i].empty() ? shortened(s.label_names[i]) : short_number(s.labels[i], 8);
}

/// The stated numbers, else round ones and the ends of the range, where they have room.
std::vector<LegendLayout::Tick> ticks_of(const ColorScale& s, const Rect& bar, double line_height) {
  std::vector<LegendLayout::Tick> ticks;
  const double last = bar.height - 1;
  if (s.limits.size() > 1) {
    // Every border of the bands, or every second, third, ... so that the numbers stay apart.
    std::vector<std::string> texts = distinct_texts(s.limits);
    if (!s.number_format.empty())
      for (size_t i = 0; i < texts.size(); ++i) texts[i] = formatted_number(s.limits[i], s.number_format);
    const size_t n = s.limits.size(), every = size_t(std::ceil(1.15 * line_height * double(n - 1) / std::max(last, 1.0)));
    for (size_t i = 0; i < n; i += std::max<size_t>(every, 1))
      ticks.push_back({s.limits[i], typeset_number(texts[i]), int(bar.y + std::lround((1 - double(i) / double(n - 1)) * last))});
    return ticks;
  }
  const auto offer = [&](double value, std::string text) {
    if (!s.number_format.empty()) text = formatted_number(value, s.number_format);
    const double t = s.position(value);
    if (!(t >= 0 && t <= 1)) return;
    const int row = int(bar.y + std::lround((1 - t) * last));
    for (const auto& other : ticks)
      if (std::abs(other.row - row) < 1.05 * line_height || other.text == typeset_number(text)) return;
    ticks.push_back({value, typeset_number(text), row});
  };
  if (!s.ticks.empty()) {
    for (const double value : s.ticks) offer(value, short_number(value, 8));
    return ticks;
  }
  const int wanted = std::clamp(int(bar.height / (2.6 * line_height)), 2, 9);
  size_t longest = 0;
  for (const TickLabel& t : nice_ticks(s.lo, s.hi, wanted, s.kind, s.linear_threshold))
    longest = std::max(longest, t.text.size()), offer(t.value, t.text);
  const double largest = std::max(std::abs(s.lo), std::abs(s.hi)), range = std::abs(s.hi - s.lo);
  const int digits = range > 0 && s.kind == ScaleKind::linear ? std::clamp(int(std::ceil(std::log10(largest / range))) + 3, 3, 15) : 3;
  for (double end : {s.lo, s.hi}) {
    const std::string exact = exact_number(end),
                      text = exact.size() <= std::max<size_t>(6, longest + 1) ? exact : short_number(end, digits);
    if (text.size() <= longest + 3) offer(end, text);
  }
  return ticks;
}

TextStyle sized(double font) {
  TextStyle style;
  style.size = font;
  return style;
}

constexpr double longest_glyph = 5, glyph_gap = 0.6;

/// The largest of 1, 2, 5, 10, ... whose glyph has room, no larger than what there is.
double glyph_value(const GlyphLegend& g, double room) { return round_below(std::min(room / g.pixels, g.most)); }

/// The glyph's row above the bar; the column is made wide enough for any, since its length is known only once the width is.
double plan_glyph(const Overlay& o, const GlyphLegend& g, double font, LegendLayout& l) {
  const double height = 1.5 * o.measure("0", sized(font)).height;
  const double value = g.pixels > 0 && g.most > 0 ? glyph_value(g, longest_glyph * font) : 0, size = value * g.pixels;
  if (size >= 3 && std::isfinite(size)) {
    l.glyph = {0, 0, size, height};
    l.glyph_text = typeset_number(short_number(value, 3)) + (g.unit.empty() ? "" : " " + g.unit);
  }
  return height + 0.5 * font;
}

/// One column with its right edge at area.right().
LegendLayout layout_one(const Overlay& o, const Legend& s, const Rect& area, double font, bool nan) {
  LegendLayout l;
  l.font = font;
  l.title = title_of(s);
  l.nan = nan;
  const TextStyle style = sized(font);
  const double line_height = o.measure("0", style).height;
  const double nan_height = nan ? 1.9 * line_height : 0;
  l.above = s.labels.empty() && s.above && s.clamp;
  l.below = s.labels.empty() && s.below && s.clamp;

  // The title stands above the bar in at most three lines, else it runs up beside the numbers.
  l.title_style = sized(font);
  l.title_style.wrap = widest_title * font;
  l.title_style.break_words = false;
  if (!l.title.empty()) l.title_size = o.measure(l.title, l.title_style);
  l.title_upwards = l.title_size.lines > 3 || l.title_size.width > widest_title * font * 1.02;
  const double height = std::min(area.height, std::max(0.66 * area.height, 15 * font));
  if (l.title_upwards) {
    // Then it wraps to the column's height, and shrinks when even that is too little.
    l.title_style.break_words = true;
    for (l.title_style.wrap = height; l.title_style.size > 5; l.title_style.size *= 0.9) {
      l.title_size = o.measure(l.title, l.title_style);
      if (l.title_size.lines <= 2) break;
    }
  }
  const double title_height = l.title.empty() || l.title_upwards ? 0 : l.title_size.height + 0.7 * font;
  const double top = std::round(area.y + 0.5 * (area.height - height));
  const double glyph_height = s.glyph ? plan_glyph(o, *s.glyph, font, l) : 0;
  double y = top + title_height + glyph_height, bottom = top + height - nan_height;

  double labels = nan ? o.measure("NaN", style).width : 0;
  const bool bar = s.labels.empty() || !s.limits.empty();
  if (!bar) {
    l.row_height = std::ceil(1.15 * line_height);
    const size_t room = size_t(std::max(1.0, std::floor((bottom - y) / l.row_height)));
    l.swatches = s.labels.size() <= room ? s.labels.size() : room - 1;
    TextStyle name = style;
    name.wrap = widest_name * font, name.ellipsize = true;
    for (size_t i = 0; i < l.swatches; ++i) l.rows.push_back(name_of_label(s, i));
    if (l.swatches < s.labels.size()) l.rows.push_back(fmt::format("\u2026 {} more", s.labels.size() - l.swatches));
    for (const std::string& row : l.rows) labels = std::max(labels, o.measure(row, name).width);
    bottom = std::min(bottom, y + double(l.rows.size()) * l.row_height);
  } else {
    if (l.above) y += triangle * font + 2;
    if (l.below) bottom -= triangle * font + 2;
    y += 0.5 * line_height, bottom -= 0.5 * line_height;  // for the half of a number that stands beyond the bar
  }
  const bool panel = bar && s.volume.has_value();
  if (panel) bottom = std::min(bottom, top + height - panel_foot * font);
  l.bar = {0, std::round(y), std::round(bar_width * font), std::max(2.0, std::round(bottom) - std::round(y))};
  if (bar) {
    l.ticks = ticks_of(s, l.bar, line_height);
    for (const auto& t : l.ticks) labels = std::max(labels, o.measure(t.text, style).width);
  }
  l.label_width = std::ceil(labels);
  if (panel) plan_opacity(s, font, l);
  const double before = panel ? l.panel.width + std::round(panel_gap * font) : 0;
  double width = before + l.bar.width + label_gap * font + l.label_width;
  if (l.title_upwards) width += 0.5 * font + l.title_size.height;
  else width = std::max(width, l.title_size.width);
  if (s.glyph) width = std::max(width, (longest_glyph + glyph_gap + 3) * font);
  l.column = {area.right() - std::ceil(width), top, std::ceil(width), height};
  l.bar.x = std::round(l.column.x + before);
  l.glyph.x = l.column.x, l.glyph.y = top + title_height;
  if (panel) l.panel = {std::round(l.column.x), l.bar.y, l.panel.width, l.bar.height};
  l.nan_y = l.bar.bottom() + (l.below ? triangle * font + 2 : 0) + 0.75 * line_height;
  return l;
}

void fill(Image& image, const Rect& r, Vec4f color) {
  if (color.w == 0) return;
  for (int y = std::max(0, int(r.y)); y < std::min(image.height, int(r.bottom())); ++y)
    for (int x = std::max(0, int(r.x)); x < std::min(image.width, int(r.right())); ++x) {
      uint8_t* p = image.at(x, y);
      for (int c = 0; c < 3; ++c) p[c] = uint8_t(255 * color[c] + 0.5f);
      if (image.channels == 4) p[3] = 255;
    }
}

void draw_bar(Image& image, Overlay& overlay, const ColorScale& s, const LegendLayout& l) {
  const int first = int(l.bar.y), n = int(l.bar.height);
  for (int i = 0; i < n; ++i) {
    double value = s.value_at(1 - double(i) / (n - 1));
    // The row of a number shows exactly the colour of that number.
    for (const auto& t : l.ticks)
      if (t.row == first + i && s.limits.empty()) value = t.value;
    fill(image, {l.bar.x, double(first + i), l.bar.width, 1}, s.color(value));
  }
  overlay.frame({l.bar.x - 0.5, l.bar.y - 0.5, l.bar.width + 1, l.bar.height + 1}, 0.35);
  const double f = l.font, middle = l.bar.x + 0.5 * l.bar.width, right = l.bar.right();
  const auto rgb = [](Vec4f c) { return Vec3f{c.x, c.y, c.z}; };
  if (l.above)
    overlay.polygon({{l.bar.x, l.bar.y - 2}, {middle, l.bar.y - 2 - triangle * f}, {right, l.bar.y - 2}}, rgb(s.color_at(2)), true);
  if (l.below)
    overlay.polygon({{l.bar.x, l.bar.bottom() + 2}, {middle, l.bar.bottom() + 2 + triangle * f}, {right, l.bar.bottom() + 2}},
                    rgb(s.color_at(-1)), true);
  const TextStyle style = sized(f);
  const double half = 0.5 * overlay.measure("0", style).height;
  for (const auto& t : l.ticks) {
    overlay.line({right, t.row + 0.5}, {right + 0.35 * f, t.row + 0.5}, std::max(1.0, 0.07 * f), 0.9);
    overlay.text(t.text, right + label_gap * f, t.row + 0.5 - half, style, true);
  }
}

// An arrow of the glyph's length, or a disc of its size, and what it stands for.
void draw_glyph(Overlay& overlay, const ColorScale& s, const GlyphLegend& g, const LegendLayout& l) {
  const double f = l.font, y = l.glyph.y + 0.5 * l.glyph.height, x = l.glyph.x, size = l.glyph.width;
  const Vec4f c = s.color(size / g.pixels);
  const Vec3f color{c.x, c.y, c.z};
  if (g.points) {
    const double tip = std::min(0.9 * f, 0.4 * size), half = 0.4 * tip, shaft = std::max(0.5, 0.12 * tip);
    overlay.polygon({{x, y - shaft},
                     {x + size - tip, y - shaft},
                     {x + size - tip, y - half},
                     {x + size, y},
                     {x + size - tip, y + half},
                     {x + size - tip, y + shaft},
                     {x, y + shaft}},
                    color, true);
  } else {
    std::vector<Vec2> rim;
    const double r = 0.5 * std::min(size, l.glyph.height);
    for (int k = 0; k < 32; ++k) rim.push_back({x + r + r * std::cos(k * 0.19634954), y + r * std::sin(k * 0.19634954)});
    overlay.polygon(rim, color, true);
  }
  const TextStyle style = sized(f);
  overlay.text("= " + l.glyph_text, x + size + glyph_gap * f, y - 0.5 * overlay.measure("0", style).height, style, true);
}

void draw_rows(Image& image, Overlay& overlay, const ColorScale& s, const LegendLayout& l) {
  TextStyle style = sized(l.font);
  style.wrap = l.label_width + 1, style.ellipsize = true;
  const double text_height = overlay.measure("0", style).height;
  const double swatch = std::floor(std::min(0.8 * l.row_height, l.bar.width));
  for (size_t i = 0; i < l.rows.size(); ++i) {
    const double y = l.bar.y + double(i) * l.row_height;
    if (i < l.swatches) {
      const Rect r{l.bar.x, std::round(y + 0.5 * (l.row_height - swatch)), l.bar.width, swatch};
      fill(image, r, s.color(s.labels[i]));
      overlay.frame({r.x - 0.5, r.y - 0.5, r.width + 1, r.height + 1}, 0.35);
    }
    overlay.text(l.rows[i], l.bar.right() + 0.6 * l.font, y + 0.5 * (l.row_height - text_height), style, true);
  }
}

}  // namespace

std::vector<LegendLayout> layout_legends(const Overlay& overlay, const std::vector<Legend>& scales, const Rect& area, double font,
                                         bool nan) {
  std::vector<LegendLayout> legends;
  for (double f = font;; f *= 0.88) {
    legends.clear();
    Rect rest{area.x, area.y + margin * f, area.width - margin * f, area.height - 2 * margin * f};
    for (size_t i = scales.size(); i-- > 0;) {
      legends.insert(legends.begin(), layout_one(overlay, scales[i], rest, f, nan));
      rest.width = legends.front().column.x - column_gap * f - rest.x;
    }
    const bool tall = std::all_of(legends.begin(), legends.end(), [&](const LegendLayout& l) {
      return (l.swatches > 0 || l.bar.height >= 3 * f) && (l.nan ? l.nan_y + 1.5 * f : l.bar.bottom()) <= l.column.bottom();
    });
    if (tall && (legends_width(legends) <= 0.6 * area.width || (f < 5.5 && legends_width(legends) <= 0.95 * area.width))) return legends;
    if (f < 3) return {};
  }
}

double legends_width(const std::vector<LegendLayout>& legends) {
  if (legends.empty()) return 0;
  return legends.back().column.right() - legends.front().column.x + 2 * margin * legends.front().font;
}

void draw_legend(Image& image, Overlay& overlay, const Legend& s, const LegendLayout& l) {
  if (!l.title.empty()) {
    if (l.title_upwards)
      overlay.text_upwards(l.title, l.column.right() - l.title_size.height, l.column.y + 0.5 * (l.column.height - l.title_size.width),
                           l.title_style);
    else overlay.text(l.title, l.column.x, l.column.y, l.title_style, true);
  }
  if (l.glyph.width > 0) draw_glyph(overlay, s, *s.glyph, l);
  if (l.panel.width > 0) draw_opacity(image, overlay, s, l);
  if (s.labels.empty() || !s.limits.empty()) draw_bar(image, overlay, s, l);
  else draw_rows(image, overlay, s, l);
  if (l.nan) {
    const TextStyle style = sized(l.font);
    const double height = overlay.measure("0", style).height;
    const Rect r{l.bar.x, std::round(l.nan_y), l.bar.width, std::floor(0.8 * height)};
    fill(image, r, s.color(std::numeric_limits<double>::quiet_NaN()));
    overlay.frame({r.x - 0.5, r.y - 0.5, r.width + 1, r.height + 1}, 0.35);
    overlay.text("NaN", l.bar.right() + label_gap * l.font, r.y + 0.5 * (r.height - height), style, true);
  }
}

}  // namespace sg
