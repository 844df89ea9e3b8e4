// SPDX-License-Identifier: Apache-2.0
// Free texts at places of a picture.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/schema/enum_words.h"
#include "render/annotate/overlay/overlay.h"

namespace sg {

enum class NotePlace { top_left, top, top_right, left, center, right, bottom_left, bottom, bottom_right };
constexpr auto enum_words(NotePlace) {
  using enum NotePlace;
  return std::array{Word{"top-left", top_left},
                    Word{"top", top},
                    Word{"top-right", top_right},
                    Word{"left", left},
                    Word{"center", center},
                    Word{"right", right},
                    Word{"bottom-left", bottom_left},
                    Word{"bottom", bottom},
                    Word{"bottom-right", bottom_right}};
}

struct PictureNote {
  std::string text;
  std::optional<Vec2> at;                 ///< of its middle: shares of the picture's width and height from the upper left corner
  NotePlace place = NotePlace::top_left;  ///< where no numbers are given
  double size = 1;                        ///< of the letters, in those of the legends
  std::optional<Vec3f> color;             ///< sRGB; none: as other text
};

/// Writes them, long ones on several lines, always inside `picture`. One at a named place stands there in `free` (what title and legends
/// leave) and goes on towards the middle where something is: `taken`, to which all that is written is added.
void draw_notes(Overlay& overlay, const std::vector<PictureNote>& notes, const Rect& picture, const Rect& free, double font,
                std::vector<Rect>& taken);

}  // namespace sg
