// SPDX-License-Identifier: Apache-2.0
// Films as animated GIF (89a): shown everywhere, with at most 255 colours a picture.
#pragma once
#include <string>

#include "image/image.h"

namespace sg {

/// Pictures one after the other; the film repeats for ever. A picture of more than 255 new colours gets those that are closest to its own
/// (cut by variance: Wu, "Efficient statistical computations for optimal color quantization", Graphics Gems II, 1991), without dithering.
/// Pixels that do not change from one picture to the next are not stored again.
class GifWriter {
 public:
  /// Throws Error(usage) for sides that are not from 1 to 65535.
  GifWriter(int width, int height, double fps);
  /// A picture of three channels and this size.
  void add(const Image& picture);
  /// The file; afterwards there is none.
  std::string finish();

 private:
  int delay();

  int width_, height_;
  double fps_;
  size_t pictures_ = 0;
  Image last_;
  std::string bytes_;
};

}  // namespace sg
