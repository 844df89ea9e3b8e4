// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/scale_bar.h"

#include <algorithm>
#include <cmath>

#include "base/text/round_number.h"
#include "base/text/text.h"

namespace sg {

namespace {

constexpr double margin = 0.9, longest = 0.22;  // font sizes; share of the picture's width
constexpr double caption_margin = 0.6;

void draw_bar(Overlay& o, const Annotation& a, const Projection& p, double font, std::vector<Rect>& taken) {
  const auto bar = scale_bar(p, a.box->center(), longest * p.width);
  if (!bar) return;
  TextStyle style;
  style.size = font;
  const std::string text = typeset_number(short_number(bar->length)) + (a.length_unit.empty() ? "" : " " + a.length_unit);
  const TextExtent e = o.measure(text, style);
  const double thick = std::max(2.0, 0.22 * font), width = std::max(e.width, bar->pixels), height = e.height + 0.35 * font + thick;
  const Rect r{p.width - margin * font - width, p.height - margin * font - height, width, height};
  const double left = r.x + 0.5 * (width - bar->pixels), y = r.bottom() - 0.5 * thick;
  o.line({left, y}, {left + bar->pixels, y}, thick);
  o.text(text, r.x + 0.5 * (width - e.width), r.y, style, true);
  taken.push_back(r.grown(0.3 * font));
}

void draw_caption(Overlay& o, const Annotation& a, const Projection& p, double font, double width, std::vector<Rect>& taken) {
  const TextStyle style = caption_style(font, width);
  const TextExtent e = o.measure(a.caption, style);
  const Rect r{0.5 * (p.width - e.width), o.height() - caption_margin * font - e.height, e.width, e.height};
  o.text(a.caption, r.x, r.y, style, true);
  taken.push_back(r.grown(0.3 * font));
}

}  // namespace

std::optional<ScaleBar> scale_bar(const Projection& p, Vec3 at, double most) {
  const double depth = p.to_eye(at).z, unit = p.parallel ? p.scale : p.scale / depth;
  if (!(p.parallel || depth > 0) || !(unit > 0) || !std::isfinite(most / unit)) return {};
  const double length = round_below(most / unit);
  return ScaleBar{length, length * unit};
}

TextStyle caption_style(double font, double width) {
  TextStyle style;
  style.size = font, style.centred = true, style.wrap = std::max(1.0, 0.55 * width);
  return style;
}

double caption_height(const Overlay& overlay, const Annotation& a, double font, double width) {
  return a.caption.empty() ? 0 : overlay.measure(a.caption, caption_style(font, width)).height + caption_margin * font;
}

void draw_foot(Overlay& overlay, const Annotation& a, const Projection& p, double font, double width, std::vector<Rect>& taken) {
  if (!a.caption.empty()) draw_caption(overlay, a, p, font, width, taken);
  if (a.scale_bar && a.box) draw_bar(overlay, a, p, font, taken);
}

}  // namespace sg
