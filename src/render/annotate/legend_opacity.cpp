// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/legend_opacity.h"

#include <algorithm>
#include <cmath>

#include "base/text/text.h"
#include "color/cie.h"

namespace sg {

namespace {

constexpr double curve_width = 3.4, plane_width = 5.6;  // font sizes
constexpr double small = 0.78;                          // letters of the foot

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

// The value of a row of the bar, as the bar shows it.
double value_of_row(const ColorScale& s, const Rect& bar, int row) { return s.value_at(1 - (row - bar.y) / std::max(1.0, bar.height - 1)); }

// Chequered ground, on which transparency can be read whatever the picture's background is.
float ground(const LegendLayout& l, int x, int y) {
  const int tile = std::max(2, int(std::lround(0.4 * l.font)));
  return ((x - int(l.panel.x)) / tile + (y - int(l.panel.y)) / tile) % 2 != 0 ? 0.86f : 1.0f;
}

constexpr Vec3f ink{0.1f, 0.1f, 0.12f};

// The area under the curve of opacity over rows, in colours of the rows.
void draw_curve(Image& image, const Legend& s, const LegendLayout& l) {
  const Rect& r = l.panel;
  const double most = largest_opacity(*s.volume);
  const int left = int(r.x), last = int(r.width) - 1, thick = std::max(1, int(std::lround(0.08 * l.font)));
  int before = -1;
  for (int row = int(r.y); row < int(r.bottom()); ++row) {
    const double value = value_of_row(s, l.bar, row);
    const Vec4f c = s.color(value);
    const double opacity = c.w > 0 ? s.volume->opacity.at(value) : 0;
    const int reach = std::clamp(int(std::lround(opacity / most * last)), 0, last);
    for (int x = 0; x <= last; ++x) {
      const float g = ground(l, left + x, row);
      put(image, left + x, row, x < reach ? Vec3f{c.x, c.y, c.z} : Vec3f{g, g, g});
    }
    // A steep part of the curve fills its row from where the row above ended.
    const int from = before < 0 ? reach : std::min(reach, before), to = before < 0 ? reach : std::max(reach, before);
    for (int x = std::max(0, from - thick + 1); x <= to; ++x) put(image, left + x, row, ink);
    before = reach;
  }
}

// Columns are the second axis, or with colours by another field the value that decides on opacity.
void draw_plane(Image& image, Overlay& overlay, const Legend& s, const LegendLayout& l) {
  const VolumeLegend& v = *s.volume;
  const TransferDetail& d = v.detail;
  const Rect& r = l.panel;
  const TransferFunction f(v.value, v.opacity, d);
  const double most = largest_opacity(v);
  const double left = d.color_by_second ? v.value.lo : d.second_lo, right = d.color_by_second ? v.value.hi : d.second_hi;
  const auto column = [&](double x) { return left + (right - left) * (x - r.x) / std::max(1.0, r.width - 1); };
  for (int y = int(r.y); y < int(r.bottom()); ++y)
    for (int x = int(r.x); x < int(r.right()); ++x) {
      const double row = value_of_row(s, l.bar, y), other = column(x);
      const auto c = d.color_by_second ? f.at(float(other), float(row)) : f.at(float(row), float(other));
      const float a = std::min(1.0f, float(c.opacity / most));
      const float below = ground(l, x, y);
      const float rgb[3] = {c.r, c.g, c.b};
      Vec3f out;
      for (int k = 0; k < 3; ++k) out[k] = a * float(linear_to_srgb(double(rgb[k]))) + (1 - a) * below;
      put(image, x, y, out);
    }
  const auto at_value = [&](double value) { return r.y + (1 - s.position(value)) * (r.height - 1) + 0.5; };
  const auto at_second = [&](double second) { return r.x + (second - left) / (right - left) * (r.width - 1) + 0.5; };
  const double thick = std::max(1.0, 0.07 * l.font);
  if (d.color_by_second) {  // the curve over the columns
    Vec2 last;
    for (int x = int(r.x); x < int(r.right()); ++x) {
      const Vec2 now{x + 0.5, r.bottom() - 0.5 - v.opacity.at(column(x)) / most * (r.height - 1)};
      if (x > int(r.x)) overlay.colored_line(last, now, thick, ink);
      last = now;
    }
  }
  const auto inside = [&](Vec2 p) { return Vec2{std::clamp(p.x, r.x, r.right()), std::clamp(p.y, r.y, r.bottom())}; };
  for (const TransferWidget& w : d.widgets) {
    const double lo = at_value(w.lo), hi = at_value(w.hi), a = at_second(w.second_lo), b = at_second(w.second_hi);
    std::vector<Vec2> corners{{a, lo}, {a, hi}, {b, hi}, {b, lo}};
    if (w.shape == TransferWidget::Shape::triangle) corners = {{a, 0.5 * (lo + hi)}, {b, hi}, {b, lo}};
    for (size_t i = 0; i < corners.size(); ++i)
      overlay.colored_line(inside(corners[i]), inside(corners[(i + 1) % corners.size()]), thick, ink);
  }
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

void draw_opacity(Image& image, Overlay& overlay, const Legend& s, const LegendLayout& l) {
  const Rect& r = l.panel;
  if (s.volume->detail.second == SecondAxis::none) draw_curve(image, s, l);
  else draw_plane(image, overlay, s, l);
  overlay.frame({r.x - 0.5, r.y - 0.5, r.width + 1, r.height + 1}, 0.35);
  TextStyle style;
  style.size = small * l.font;
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
