// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/annotate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "render/annotate/axes.h"
#include "render/annotate/legend.h"
#include "render/annotate/overlay.h"
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

struct Plan {
  double font;
  TextStyle title_style;
  Rect title;
  std::vector<LegendLayout> legends;
};

Plan plan(const Overlay& o, const Annotation& a, int width, int height) {
  Plan p;
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
  p.legends = layout_legends(o, a.legends, {0, top, double(width), height - top}, p.font, a.show_nan_in_legend);
  return p;
}

}  // namespace

int legend_width(const Annotation& a, int width, int height) {
  if (a.legends.empty()) return 0;
  const Overlay measuring(1, 1, a.dark_background);
  return int(std::ceil(legends_width(plan(measuring, a, width, height).legends)));
}

Rect area_beside(const Annotation& a, int width, int height) {
  const Overlay measuring(1, 1, a.dark_background);
  const Plan p = plan(measuring, a, width, height);
  const double top = a.title.empty() ? 0 : std::ceil(p.title.bottom());
  return {0, top, std::max(1.0, double(width) - std::ceil(legends_width(p.legends))), std::max(1.0, double(height) - top)};
}

void annotate(Image& image, const Annotation& a, const Projection& projection) {
  if (image.channels < 3)
    fail_usage(fmt::format("an image of {} channels cannot be annotated", image.channels), "annotate", "3 or 4 channels are needed");
  if (image.width < 1 || image.height < 1) fail_usage("an image without pixels cannot be annotated", "annotate");
  Overlay overlay(image.width, image.height, a.dark_background);
  const Plan p = plan(overlay, a, image.width, image.height);

  // What must not be written over, in order of importance: title, legends, sides of the patient, triad, axes.
  std::vector<Rect> taken;
  if (!a.title.empty()) {
    overlay.text(a.title, p.title.x, p.title.y, p.title_style, true);
    taken.push_back(p.title);
  }
  for (const LegendLayout& l : p.legends) taken.push_back(l.column.grown(0.5 * l.font));
  if (a.patient_letters) draw_patient_letters(overlay, projection, p.font, taken);
  const Rect triad = triad_place(image.width, image.height, p.font);
  const bool room_for_triad = a.triad && triad.width < 0.45 * image.width && triad.height < 0.45 * image.height;
  if (room_for_triad) taken.push_back(triad);
  draw_foot(overlay, a, projection, p.font, taken);
  overlay.keep_clear(taken);
  draw_texts(overlay, a.texts, projection, 0.88 * p.font, taken);
  draw_box_axes(overlay, a, projection, p.font, taken);
  overlay.keep_clear({});
  if (room_for_triad) draw_triad(overlay, a, projection, p.font);
  for (size_t i = 0; i < p.legends.size(); ++i) draw_legend(image, overlay, a.legends[i], p.legends[i]);
  overlay.put_on(image);
}

}  // namespace sg
