// SPDX-License-Identifier: Apache-2.0
// Pictures of light, without an upper end: linear RGB.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "base/vec.h"

namespace sg {

struct LinearPicture {
  int width = 0, height = 0;
  std::vector<Vec3f> pixels;  ///< rows from the top; linear, the primaries of sRGB
};

/// Radiance's RGBE, flat or run-length encoded; EXPOSURE and COLORCORR are undone, so that the numbers are those of the scene. Source: Ward
/// 1991, and the Radiance reference "Picture file format". Throws Error(data) for another file, one that is
/// cut off, other than RGB, above 2^26 pixels, or with pixels that fill more than 256 MiB and 200 times its size.
LinearPicture decode_hdr(std::span<const std::byte> bytes, const std::string& name);

}  // namespace sg
