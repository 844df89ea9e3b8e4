// SPDX-License-Identifier: Apache-2.0
// Many pictures on one sheet, each with its caption.
#pragma once
#include <string>
#include <vector>

#include "image/image.h"

namespace sg {

struct CaptionedImage {
  Image image;
  std::string caption;
};

/// Pictures side by side in `columns`, each scaled to fit into cells of `width` that are as high as the tallest of them is at that width,
/// or square (keeping its proportions, averaged in linear light), the caption below, cut with "..." when it is longer than the picture is
/// wide. RGB.
Image contact_sheet(const std::vector<CaptionedImage>& pictures, int columns = 4, int width = 480);

}  // namespace sg
