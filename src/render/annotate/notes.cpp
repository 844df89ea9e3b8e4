// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/notes.h"

#include <algorithm>

namespace sg {

namespace {

constexpr double to_edge = 0.8, between = 0.3;  // font sizes

// 0, 1 or 2: left, middle, right; above, middle, below.
int column_of(NotePlace p) { return int(p) % 3; }
int line_of(NotePlace p) { return int(p) / 3; }

// The first free place from the named one on; the named one where none is.
Rect named_rect(const PictureNote& n, TextExtent e, const Rect& free, double font, const std::vector<Rect>& taken) {
  const double edge = to_edge * font, x = free.x + edge + 0.5 * column_of(n.place) * (free.width - 2 * edge - e.width);
  const Rect first{x, free.y + edge + 0.5 * line_of(n.place) * (free.height - 2 * edge - e.height), e.width, e.height};
  Rect r = first;
  for (int tries = 0; tries < 100; ++tries) {
    const auto in_way = std::find_if(taken.begin(), taken.end(), [&](const Rect& t) { return t.overlaps(r); });
    if (in_way == taken.end()) return r;
    r.y = line_of(n.place) == 2 ? in_way->y - between * font - r.height : in_way->bottom() + between * font;
    if (r.y < free.y || r.bottom() > free.bottom()) break;
  }
  return first;
}

}  // namespace

void draw_notes(Overlay& o, const std::vector<PictureNote>& notes, const Rect& picture, const Rect& free, double font,
                std::vector<Rect>& taken) {
  constexpr double border = 2;  // pixels
  for (const PictureNote& n : notes) {
    TextStyle style;
    style.wrap = std::max(1.0, 0.6 * picture.width), style.centred = n.at || column_of(n.place) == 1;
    TextExtent e;
    for (style.size = n.size * font; style.size > 2; style.size *= 0.93) {
      e = o.measure(n.text, style);
      if (e.height <= 0.9 * picture.height && e.width <= style.wrap * 1.001) break;
    }
    Rect r = n.at ? Rect{picture.x + n.at->x * picture.width - 0.5 * e.width, picture.y + n.at->y * picture.height - 0.5 * e.height,
                         e.width, e.height}
                  : named_rect(n, e, free, font, taken);
    r.x = std::max(std::min(r.x, picture.right() - border - r.width), picture.x + border);
    r.y = std::max(std::min(r.y, picture.bottom() - border - r.height), picture.y + border);
    if (n.color) o.colored_text(n.text, r.x, r.y, style, *n.color);
    else o.text(n.text, r.x, r.y, style, true);
    taken.push_back(r.grown(0.2 * font));
  }
}

}  // namespace sg
