// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/legend/opacity.h"

#include <algorithm>
#include <cmath>

#include "base/text/text.h"
#include "color/cie.h"
#include "color/widgets/outline.h"
#include "color/widgets/transfer_widget.h"

namespace sg {

namespace {

constexpr double curve_width = 3.4, plane_width = 5.6;  // font sizes
constexpr double small = 0.78;                          // letters at the ends
constexpr double text_gap = 0.5, widest_caption = 11;   // beside a lying panel

// Largest opacity on the part of the value's axis that is shown.
double largest_opacity(const VolumeLegend& v) {
  double most = 0;
  for (const TransferWidget& w : v.detail.widgets) most = std::max(most, w.opacity);
  if (v.detail.widgets.empty()) most = v.opacity.most(v.value.lo, v.value.hi);
  return most > 0 ? most : 1;
}

// Two digits, or all before the point.
std::string end_text(double v) {
  const double size = std::abs(v);
  return typeset_number(short_number(v, size >= 100 && size < 1e5 ? int(std::log10(size)) + 1 : 2));
}

void put(Image& image, int x, int y, Vec3f srgb) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  uint8_t* p = image.at(x, y);
  for (int c = 0; c < 3; ++c) p[c] = uint8_t(255 * std::clamp(srgb[c], 0.0f, 1.0f) + 0.5f);
  if (image.channels == 4) p[3] = 255;
}

// The panel in the directions of what it shows: `along` the bar from its first pixel on, `across` from the panel's edge of low opacity.
struct Directions {
  const LegendLayout& l;
  bool lies = l.lies();
  int x0 = int(l.panel.x), y0 = int(l.panel.y);
  int along = int(lies ? l.panel.width : l.panel.height), across = int(lies ? l.panel.height : l.panel.width);

  int x(int a, int c) const { return x0 + (lies ? a : c); }
  int y(int a, int c) const { return y0 + (lies ? across - 1 - c : a); }
  // As the bar shows it.
  double value(const ColorScale& s, int a) const {
    if (lies) return s.value_at((x0 + a - l.bar.x) / std::max(1.0, l.bar.width - 1));
    return s.value_at(1 - (y0 + a - l.bar.y) / std::max(1.0, l.bar.height - 1));
  }
  // The middle of a pixel, from positions 0 to 1 on the bar and across the panel.
  Vec2 place(double position, double share) const {
    const Rect& r = l.panel;
    if (lies) return {r.x + position * (r.width - 1) + 0.5, r.y + (1 - share) * (r.height - 1) + 0.5};
    return {r.x + share * (r.width - 1) + 0.5, r.y + (1 - position) * (r.height - 1) + 0.5};
  }
};

// Chequered ground, on which transparency can be read whatever the picture's background is.
float ground(const LegendLayout& l, int x, int y) {
  const int tile = std::max(2, int(std::lround(0.4 * l.font)));
  return ((x - int(l.panel.x)) / tile + (y - int(l.panel.y)) / tile) % 2 != 0 ? 0.86f : 1.0f;
}

constexpr Vec3f ink{0.1f, 0.1f, 0.12f};

// The area under the curve of opacity over the bar's pixels, in their colours.
void draw_curve(Image& image, const Legend& s, const LegendLayout& l) {
  const Directions d{l};
  const double most = largest_opacity(*s.volume);
  const int last = d.across - 1, thick = std::max(1, int(std::lround(0.08 * l.font)));
  int before = -1;
  for (int i = 0; i < d.along; ++i) {
    const double value = d.value(s, i);
    const Vec4f c = s.color(value);
    const double opacity = c.w > 0 ? s.volume->opacity.at(value) : 0;
    const int reach = std::clamp(int(std::lround(opacity / most * last)), 0, last);
    for (int k = 0; k <= last; ++k) {
      const float g = ground(l, d.x(i, k), d.y(i, k));
      put(image, d.x(i, k), d.y(i, k), k < reach ? Vec3f{c.x, c.y, c.z} : Vec3f{g, g, g});
    }
    // A steep part of the curve fills its row from where the one before ended.
    const int from = before < 0 ? reach : std::min(reach, before), to = before < 0 ? reach : std::max(reach, before);
    for (int k = std::max(0, from - thick + 1); k <= to; ++k) put(image, d.x(i, k), d.y(i, k), ink);
    before = reach;
  }
}

// Across is the second axis, or with colours by another field the value that decides on opacity.
void draw_plane(Image& image, Overlay& overlay, const Legend& s, const LegendLayout& l) {
  const VolumeLegend& v = *s.volume;
  const TransferDetail& t = v.detail;
  const Directions d{l};
  const TransferFunction f(v.value, v.opacity, t);
  const double most = largest_opacity(v);
  const double low = t.color_by_second ? v.value.lo : t.second_lo, high = t.color_by_second ? v.value.hi : t.second_hi;
  const auto second = [&](int c) { return low + (high - low) * c / std::max(1.0, d.across - 1.0); };
  for (int i = 0; i < d.along; ++i)
    for (int k = 0; k < d.across; ++k) {
      const double along = d.value(s, i), other = second(k);
      const auto c = t.color_by_second ? f.at(float(other), float(along)) : f.at(float(along), float(other));
      const float a = std::min(1.0f, float(c.opacity / most));
      const float below = ground(l, d.x(i, k), d.y(i, k));
      const float rgb[3] = {c.r, c.g, c.b};
      Vec3f out;
      for (int n = 0; n < 3; ++n) out[n] = a * float(linear_to_srgb(double(rgb[n]))) + (1 - a) * below;
      put(image, d.x(i, k), d.y(i, k), out);
    }
  const double thick = std::max(1.0, 0.07 * l.font);
  if (t.color_by_second) {  // the curve, highest at the bar's high end
    Vec2 last;
    for (int k = 0; k < d.across; ++k) {
      const Vec2 now = d.place(v.opacity.at(second(k)) / most, k / std::max(1.0, d.across - 1.0));
      if (k > 0) overlay.colored_line(last, now, thick, ink);
      last = now;
    }
  }
  const auto at = [&](Vec2 p) { return d.place(s.position(p.x), (p.y - low) / (high - low)); };
  const auto inside = [&](Vec2 p) {
    return Vec2{std::clamp(p.x, l.panel.x, l.panel.right()), std::clamp(p.y, l.panel.y, l.panel.bottom())};
  };
  for (const TransferWidget& w : t.widgets)
    for (std::vector<Vec2>& line : outline(w)) {
      for (Vec2& p : line) p = inside(at(p));
      overlay.colored_line(line, thick, ink);
    }
}

TextStyle small_letters(const LegendLayout& l) {
  TextStyle style;
  style.size = small * l.font;
  return style;
}

// Right of the panel, from above: its upper end, what it is, its lower end.
void draw_texts_beside(Overlay& overlay, const LegendLayout& l) {
  TextStyle style = small_letters(l);
  const Rect& r = l.panel;
  const double x = r.right() + text_gap * l.font, line = overlay.measure("0", style).height;
  overlay.text(l.panel_right, x, r.y - 0.15 * line, style, true);
  overlay.text(l.panel_left, x, r.bottom() - 0.85 * line, style, true);
  style.wrap = widest_caption * l.font, style.ellipsize = true;
  overlay.text(l.panel_caption, x, r.y + 0.5 * (r.height - line), style, true);
}

}  // namespace

void plan_opacity(const Legend& legend, double font, LegendLayout& l) {
  const VolumeLegend& v = *legend.volume;
  const bool plane = v.detail.second != SecondAxis::none;
  l.panel.width = std::round((plane ? plane_width : curve_width) * font);
  if (plane) {
    const bool by = v.detail.color_by_second;
    const double lo = by ? v.value.lo : v.detail.second_lo, hi = by ? v.value.hi : v.detail.second_hi;
    l.panel_left = end_text(lo), l.panel_right = end_text(hi);
    l.panel_caption = by ? "opacity by " + v.value.title : v.second_title;
  } else {
    l.panel_left = "0", l.panel_right = end_text(largest_opacity(v));
    l.panel_caption = "opacity";
  }
}

double opacity_text_width(const Overlay& overlay, const LegendLayout& l) {
  TextStyle style = small_letters(l);
  double width = std::max(overlay.measure(l.panel_left, style).width, overlay.measure(l.panel_right, style).width);
  style.wrap = widest_caption * l.font, style.ellipsize = true;
  width = std::max(width, overlay.measure(l.panel_caption, style).width);
  return width + text_gap * l.font;
}

void draw_opacity(Image& image, Overlay& overlay, const Legend& s, const LegendLayout& l) {
  const Rect& r = l.panel;
  if (s.volume->detail.second == SecondAxis::none) draw_curve(image, s, l);
  else draw_plane(image, overlay, s, l);
  overlay.frame({r.x - 0.5, r.y - 0.5, r.width + 1, r.height + 1}, 0.35);
  if (l.lies()) return draw_texts_beside(overlay, l);
  TextStyle style = small_letters(l);
  const double y = r.bottom() + 0.25 * l.font, line = overlay.measure("0", style).height;
  overlay.text(l.panel_left, r.x, y, style, true);
  overlay.text(l.panel_right, r.right() - overlay.measure(l.panel_right, style).width, y, style, true);
  // A long caption goes on below the bar, where no swatch of NaN is.
  const double wanted = overlay.measure(l.panel_caption, style).width;
  style.wrap = wanted <= r.width || l.nan ? r.width : l.column.right() - r.x, style.ellipsize = true;
  const double width = std::min(wanted, r.width);
  overlay.text(l.panel_caption, r.x + 0.5 * (r.width - width), y + 0.95 * line, style, true);
}

}  // namespace sg
