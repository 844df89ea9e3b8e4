// SPDX-License-Identifier: Apache-2.0
// Text and rulers over a picture: legends, title, axes with numbers, orientation triad. Cairo and Pango.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "color/legend_content.h"
#include "image/image.h"
#include "render/annotate/notes.h"
#include "render/annotate/overlay/overlay.h"
#include "scene/camera.h"
#include "scene/scene.h"

namespace sg {

struct Annotation {
  std::string caption;     ///< bottom centre
  bool scale_bar = false;  ///< lower right: a bar of a round length at the middle of the box
  std::string title;       ///< top centre; long titles wrap, then shrink, never crop
  /// Each at its side, side by side; exactly the colours drawn, title, unit, ticks. A `below` or `above` colour that is set shows
  /// as a triangle at that end: set it, to the end colour if need be, when data lies out of range.
  std::vector<Legend> legends;
  std::optional<Box3> box;                      ///< bounding box with numbered axes (the box lines themselves are scene lines)
  bool axes = true;                             ///< false: the box has no numbers
  std::string axis_names[3] = {"x", "y", "z"};  ///< of the triad
  std::string axis_titles[3];                   ///< of the box: "depth [m]"; "" = the name and the length unit
  std::string length_unit;
  Vec3 stretch{1, 1, 1};            ///< an axis is drawn so much longer than its numbers say, where negative the other way round
  std::vector<TextItem> texts;      ///< earlier ones first: those that would touch another text, a legend or the border are left out
  std::vector<PictureNote> notes;   ///< in the image
  bool triad = true;                ///< orientation axes, lower left
  bool patient_letters = false;     ///< the world is the patient frame: R L A P I S at the edges of the picture beside the legends
  bool show_nan_in_legend = false;  ///< NaN swatch (the data has NaN)
  bool dark_background = false;     ///< light text
  double scale = 1;                 ///< text size factor; 1 suits 720 lines, and text grows with the picture's height
};

/// Pixels at each side that legends will take (0 without legends), with the title above those at the top and the caption below those at the
/// bottom: the picture itself is drawn in the rest.
struct LegendRoom {
  int left = 0, right = 0, top = 0, bottom = 0;
};
LegendRoom legend_room(const Annotation& annotation, int width, int height);

/// What title and legends leave of a picture, in whole pixels.
Rect area_beside(const Annotation& annotation, int width, int height);

/// Draws onto the image (3 or 4 channels), in which the projection's picture has its upper left corner at the pixel (x, y). Throws
/// Error(internal) naming the package when no font is installed.
void annotate(Image& image, const Annotation& annotation, const Projection& projection, int x = 0, int y = 0);

}  // namespace sg
