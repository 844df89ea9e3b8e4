// SPDX-License-Identifier: Apache-2.0
// Where title and legends of a picture lie, for others who draw them.
#pragma once
#include <vector>

#include "render/annotate/annotate.h"
#include "render/annotate/legend/legend.h"

namespace sg {

struct AnnotationPlan {
  double font = 15;  ///< pixels
  TextStyle title_style;
  Rect title;
  double caption = 0;  ///< height that it takes below legends; 0: it stands in the picture
  std::vector<LegendLayout> legends;
};
/// Of a picture of that size.
AnnotationPlan plan_annotation(const Overlay& measuring, const Annotation& annotation, int width, int height);

}  // namespace sg
