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
  constexpr int most_steps = 24;
  constexpr double clear = 1.5;  // of other texts, in heights of the font
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
    const bool upright = e.y == 0.5;
    // In the middle of its edge, or as near to it as it keeps clear of the other texts.
    for (int step = 0; step <= most_steps; ++step) {
      const double aside = 0.5 * font * double(step % 2 ? -(step + 1) / 2 : step / 2);
      const Rect r{margin + e.x * (width - size.width - 2 * margin) + (upright ? 0 : aside),
                   top + margin + e.y * (height - top - size.height - 2 * margin) + (upright ? aside : 0), size.width, size.height};
      const Rect room = r.grown(clear * font);
      if (std::any_of(taken.begin(), taken.end(), [&](const Rect& t) { return t.overlaps(room); })) continue;
      o.text(e.letters, r.x, r.y, style, true);
      taken.push_back(r.grown(0.2 * font));
      break;
    }
  }
}

}  // namespace sg
