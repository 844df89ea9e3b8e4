// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/patient_sides.h"

#include <algorithm>

#include "data/patient/patient_frame.h"

namespace sg {

PatientSides patient_sides(const Projection& p) {
  return {patient_letters(-p.right), patient_letters(p.right), patient_letters(p.up), patient_letters(-p.up)};
}

void draw_patient_letters(Overlay& o, const Projection& p, double font, std::vector<Rect>& taken) {
  TextStyle style;
  style.size = 1.25 * font;
  style.bold = true;
  // The picture reaches to the legends; a title is above all of it.
  const double width = p.width, height = p.height, margin = 0.6 * font;
  double top = 0;
  for (const Rect& r : taken)
    if (r.y < 0.2 * height && r.x < 0.5 * width && r.right() > 0.5 * width) top = std::max(top, r.bottom());
  const PatientSides sides = patient_sides(p);
  const struct {
    const std::string& letters;
    double x, y;  // in shares of the room
  } edges[] = {{sides.left, 0, 0.5}, {sides.right, 1, 0.5}, {sides.top, 0.5, 0}, {sides.bottom, 0.5, 1}};
  for (const auto& e : edges) {
    const TextExtent size = o.measure(e.letters, style);
    const Rect r{margin + e.x * (width - size.width - 2 * margin), top + margin + e.y * (height - top - size.height - 2 * margin),
                 size.width, size.height};
    if (std::any_of(taken.begin(), taken.end(), [&](const Rect& t) { return t.overlaps(r); })) continue;
    o.text(e.letters, r.x, r.y, style, true);
    // Titles of axes keep so far from them along the edge that they are not read together.
    const double along = 3 * font, across = 0.5 * font;
    const double dx = e.y == 0.5 ? across : along, dy = e.y == 0.5 ? along : across;
    taken.push_back({r.x - dx, r.y - dy, r.width + 2 * dx, r.height + 2 * dy});
  }
}

}  // namespace sg
