// SPDX-License-Identifier: Apache-2.0
// Legends as their layouts say.
#include <algorithm>
#include <cmath>

#include "render/annotate/legend/opacity.h"
#include "render/annotate/legend/parts.h"

namespace sg {

namespace {

using legend::sized;

void fill(Image& image, const Rect& r, Vec4f color) {
  if (color.w == 0) return;
  for (int y = std::max(0, int(r.y)); y < std::min(image.height, int(r.bottom())); ++y)
    for (int x = std::max(0, int(r.x)); x < std::min(image.width, int(r.right())); ++x) {
      uint8_t* p = image.at(x, y);
      for (int c = 0; c < 3; ++c) p[c] = uint8_t(255 * color[c] + 0.5f);
      if (image.channels == 4) p[3] = 255;
    }
}

void draw_swatch(Image& image, Overlay& overlay, const Rect& r, Vec4f color) {
  fill(image, r, color);
  overlay.frame({r.x - 0.5, r.y - 0.5, r.width + 1, r.height + 1}, 0.35);
}

void draw_colors(Image& image, const ColorScale& s, const LegendLayout& l) {
  const bool lies = l.lies();
  const int first = int(lies ? l.bar.x : l.bar.y), n = int(lies ? l.bar.width : l.bar.height);
  for (int i = 0; i < n; ++i) {
    double value = s.value_at(lies ? double(i) / (n - 1) : 1 - double(i) / (n - 1));
    // The row of a number shows exactly the colour of that number.
    for (const auto& t : l.ticks)
      if (t.row == first + i && s.limits.empty()) value = t.value;
    fill(image, lies ? Rect{double(first + i), l.bar.y, 1, l.bar.height} : Rect{l.bar.x, double(first + i), l.bar.width, 1},
         s.color(value));
  }
}

// The colours beyond the ends, as triangles.
void draw_tips(Overlay& overlay, const ColorScale& s, const LegendLayout& l) {
  const auto rgb = [](Vec4f c) { return Vec3f{c.x, c.y, c.z}; };
  const Rect& b = l.bar;
  const double tip = legend::triangle * l.font;
  if (l.lies()) {
    const double middle = b.y + 0.5 * b.height;
    if (l.above)
      overlay.polygon({{b.right() + 2, b.y}, {b.right() + 2 + tip, middle}, {b.right() + 2, b.bottom()}}, rgb(s.color_at(2)), true);
    if (l.below) overlay.polygon({{b.x - 2, b.y}, {b.x - 2 - tip, middle}, {b.x - 2, b.bottom()}}, rgb(s.color_at(-1)), true);
    return;
  }
  const double middle = b.x + 0.5 * b.width;
  if (l.above) overlay.polygon({{b.x, b.y - 2}, {middle, b.y - 2 - tip}, {b.right(), b.y - 2}}, rgb(s.color_at(2)), true);
  if (l.below)
    overlay.polygon({{b.x, b.bottom() + 2}, {middle, b.bottom() + 2 + tip}, {b.right(), b.bottom() + 2}}, rgb(s.color_at(-1)), true);
}

void draw_bar(Image& image, Overlay& overlay, const ColorScale& s, const LegendLayout& l) {
  draw_colors(image, s, l);
  overlay.frame({l.bar.x - 0.5, l.bar.y - 0.5, l.bar.width + 1, l.bar.height + 1}, 0.35);
  draw_tips(overlay, s, l);
  const double f = l.font, right = l.bar.right(), bottom = l.bar.bottom(), thick = std::max(1.0, 0.07 * f);
  const TextStyle style = sized(f);
  const double half = 0.5 * overlay.measure("0", style).height;
  for (const auto& t : l.ticks) {
    const double at = t.row + 0.5;
    if (l.lies()) {
      overlay.line({at, bottom}, {at, bottom + 0.35 * f}, thick, 0.9);
      overlay.text(t.text, at - 0.5 * overlay.measure(t.text, style).width, bottom + 0.45 * f, style, true);
    } else {
      overlay.line({right, at}, {right + 0.35 * f, at}, thick, 0.9);
      overlay.text(t.text, right + legend::label_gap * f, at - half, style, true);
    }
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
  overlay.text("= " + l.glyph_text, x + size + legend::glyph_gap * f, y - 0.5 * overlay.measure("0", style).height, style, true);
}

void draw_rows(Image& image, Overlay& overlay, const ColorScale& s, const LegendLayout& l) {
  TextStyle style = sized(l.font);
  style.wrap = l.label_width + 1, style.ellipsize = true;
  const double text_height = overlay.measure("0", style).height;
  const double swatch = std::floor(std::min(0.8 * l.row_height, l.bar.width));
  for (size_t i = 0; i < l.rows.size(); ++i) {
    const double x = l.bar.x + double(i % l.across) * l.row_width, y = l.bar.y + double(i / l.across) * l.row_height;
    if (i < l.swatches)
      draw_swatch(image, overlay, {x, std::round(y + 0.5 * (l.row_height - swatch)), l.bar.width, swatch}, s.color(s.labels[i]));
    overlay.text(l.rows[i], x + l.bar.width + 0.6 * l.font, y + 0.5 * (l.row_height - text_height), style, true);
  }
}

void draw_nan(Image& image, Overlay& overlay, const ColorScale& s, const LegendLayout& l) {
  const TextStyle style = sized(l.font);
  const double height = overlay.measure("0", style).height;
  // Beside a lying bar as high as it, in a list as the others; below a standing one a little lower than a letter.
  const bool bar = legend::has_bar(s);
  Rect r{l.nan_at.x, std::round(l.nan_at.y), std::round(legend::bar_width * l.font), std::floor(0.8 * height)};
  if (l.lies() && bar) r.height = l.bar.height;
  else if (l.lies())
    r.height = std::floor(std::min(0.8 * l.row_height, r.width)), r.y = std::round(l.nan_at.y + 0.5 * (l.row_height - r.height));
  draw_swatch(image, overlay, r, s.color(std::numeric_limits<double>::quiet_NaN()));
  overlay.text("NaN", r.right() + (l.lies() && !bar ? 0.6 : legend::label_gap) * l.font, r.y + 0.5 * (r.height - height), style, true);
}

}  // namespace

void draw_legend(Image& image, Overlay& overlay, const Legend& s, const LegendLayout& l) {
  if (!l.title.empty()) {
    if (l.title_upwards) overlay.text_upwards(l.title, l.title_at.x, l.title_at.y, l.title_style);
    else overlay.text(l.title, l.title_at.x, l.title_at.y, l.title_style, true);
  }
  if (l.glyph.width > 0) draw_glyph(overlay, s, *s.glyph, l);
  if (l.panel.width > 0) draw_opacity(image, overlay, s, l);
  if (legend::has_bar(s)) draw_bar(image, overlay, s, l);
  else draw_rows(image, overlay, s, l);
  if (l.nan) draw_nan(image, overlay, s, l);
}

}  // namespace sg
