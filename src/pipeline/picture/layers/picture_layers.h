// SPDX-License-Identifier: Apache-2.0
// The layers of a picture as data: what each pixel shows, how exact it is, and what lies behind the colours.
#pragma once
#include "data/dataset.h"
#include "pipeline/picture/picture.h"

namespace sg {

/// A grid of width x height points at the middles of the pixels, in pixels from the lower left, with the point fields that there are of
///   light     4 components: linear, premultiplied by the opacity in the fourth; before texts and legends
///   color     3 or 4 bytes, sRGB: the picture as its file has it
///   depth     along the view, in units of the data; NaN where nothing is
///   show      which entry under `show`, from 1; 0 where none is
///   error     standard error of the pixel as displayed, as a share of full scale
///   albedo    3 components: colours without light, linear;   normal   3 components: to the right, up, to the viewer
DatasetPtr layers_of(const Picture& picture);

}  // namespace sg
