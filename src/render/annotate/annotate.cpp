// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/annotate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "render/annotate/annotation_plan.h"
#include "render/annotate/axes.h"
#include "render/annotate/legend/legend.h"
#include "render/annotate/overlay/overlay.h"
#include "render/annotate/patient_sides.h"
#include "render/annotate/scale_bar.h"
#include "render/annotate/texts.h"

namespace sg {
namespace {

/// 15 pixels at 720 lines; narrow pictures count by their width. Below 9 pixels letters cannot be read.
double font_size(const Annotation& a, int width, int height) {
  const double lines = std::min(double(height), 0.8 * width);
  return std::max(9.0, 15 * lines / 720) * (a.scale > 0 ? a.scale : 1);
}

}  // namespace

AnnotationPlan plan_annotation(const Overlay& o, const Annotation& a, int width, int height) {
  AnnotationPlan p;
  p.font = font_size(a, width, height);
  double top = 0;
  if (!a.title.empty()) {
    TextStyle& s = p.title_style;
    s.centred = true;
    s.wrap = std::max(1.0, width - 1.6 * p.font);
    TextExtent e;
    for (s.size = 1.3 * p.font; s.size > 2; s.size *= 0.93) {
      e = o.measure(a.title, s);
      if (e.height <= 0.18 * height && e.width <= s.wrap * 1.001) break;
    }
    p.title = {0.5 * (width - e.width), 0.6 * p.font, e.width, e.height};
    top = p.title.bottom();
  }
  if (std::any_of(a.legends.begin(), a.legends.end(), [](const Legend& l) { return l.place == LegendPlace::bottom; }))
    p.caption = caption_height(o, a, p.font, width);
  p.legends = layout_legends(o, a.legends, {0, top, double(width), height - top - p.caption}, p.font, a.show_nan_in_legend);
  return p;
}

namespace {

LegendRoom room_of(const AnnotationPlan& p, const Annotation& a) {
  const auto at = [&](LegendPlace side) { return legends_width(p.legends, side); };
  LegendRoom r{int(std::ceil(at(LegendPlace::left))), int(std::ceil(at(LegendPlace::right))), 0, 0};
  if (const double top = at(LegendPlace::top); top > 0) r.top = int(std::ceil((a.title.empty() ? 0 : p.title.bottom()) + top));
  if (const double bottom = at(LegendPlace::bottom); bottom > 0) r.bottom = int(std::ceil(p.caption + bottom));
  return r;
}

Rect area_of(const AnnotationPlan& p, const Annotation& a, int width, int height) {
  const LegendRoom room = room_of(p, a);
  const double top = room.top > 0 ? room.top : a.title.empty() ? 0 : std::ceil(p.title.bottom());
  return {double(room.left), top, std::max(1.0, double(width - room.left - room.right)), std::max(1.0, height - top - room.bottom)};
}

}  // namespace

LegendRoom legend_room(const Annotation& a, int width, int height) {
  if (a.legends.empty()) return {};
  const Overlay measuring(1, 1, a.dark_background);
  return room_of(plan_annotation(measuring, a, width, height), a);
}

Rect area_beside(const Annotation& a, int width, int height) {
  const Overlay measuring(1, 1, a.dark_background);
  return area_of(plan_annotation(measuring, a, width, height), a, width, height);
}

void annotate(Image& image, const Annotation& a, const Projection& projection, int x, int y) {
  if (image.channels < 3)
    fail_usage(fmt::format("an image of {} channels cannot be annotated", image.channels), "annotate", "3 or 4 channels are needed");
  if (image.width < 1 || image.height < 1) fail_usage("an image without pixels cannot be annotated", "annotate");
  Overlay overlay(image.width, image.height, a.dark_background);
  const AnnotationPlan p = plan_annotation(overlay, a, image.width, image.height);

  // What must not be written over, in order of importance: title, legends, sides of the patient, triad, notes, axes.
  std::vector<Rect> taken;
  if (!a.title.empty()) {
    overlay.text(a.title, p.title.x, p.title.y, p.title_style, true);
    taken.push_back(p.title);
  }
  for (const LegendLayout& l : p.legends) taken.push_back(l.column.grown(0.5 * l.font));
  // Then in the pixels of the picture beside the legends.
  for (Rect& r : taken) r.x -= x, r.y -= y;
  overlay.set_origin(x, y);
  if (a.patient_letters) draw_patient_letters(overlay, projection, p.font, taken);
  const Rect triad = triad_place(projection.width, projection.height, p.font);
  const bool room_for_triad = a.triad && triad.width < 0.45 * image.width && triad.height < 0.45 * image.height;
  if (room_for_triad) taken.push_back(triad);
  draw_foot(overlay, a, projection, p.font, p.caption > 0 ? image.width : projection.width, taken);
  if (!a.notes.empty()) {
    Rect free = area_of(p, a, image.width, image.height);
    free.x -= x, free.y -= y;
    draw_notes(overlay, a.notes, {double(-x), double(-y), double(image.width), double(image.height)}, free, p.font, taken);
  }
  overlay.keep_clear(taken);
  draw_texts(overlay, a.texts, projection, 0.88 * p.font, taken);
  draw_box_axes(overlay, a, projection, p.font, taken);
  overlay.keep_clear({});
  if (room_for_triad) draw_triad(overlay, a, projection, p.font);
  overlay.set_origin(0, 0);
  for (size_t i = 0; i < p.legends.size(); ++i) draw_legend(image, overlay, a.legends[i], p.legends[i]);
  overlay.put_on(image);
}

}  // namespace sg
