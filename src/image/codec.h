// SPDX-License-Identifier: Apache-2.0
// Images to and from files.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "image/image.h"

namespace sg {

/// The encoder is chosen by the extension: png, jpg/jpeg, webp. Written to a temporary file and renamed. Throws Error(usage) for any other
/// extension, Error(data) when the file cannot be written.
void write_image(const std::string& path, const Image& image);
/// The bytes that write_image would write; throws the same Error(usage), Error(data) for an image that the format cannot hold.
std::string encode_image(const std::string& path, const Image& image);
/// Extensions that write_image knows.
const std::vector<std::string>& image_extensions();

/// PNG, deterministic bytes: filter rows in parallel, deflate in independent stripes (fixed size, so the same bytes for any
/// number of threads). `text` goes to tEXt (Latin-1) or iTXt (UTF-8) chunks, zTXt/compressed iTXt above 1 KiB.
std::vector<uint8_t> encode_png(const Image& image);
/// JPEG without loss of colour resolution; transparent pixels lie on white. `quality`: 1 to 100.
std::string encode_jpeg(const Image& image, int quality);
/// Throws Error(data) for anything that is not a PNG of 8 bits or can be turned into one, and for one whose pixels fill more than 256 MiB
/// and 100 times its size. Text chunks are returned in `text`: 64 MiB of them together, longer ones are left out.
Image decode_png(std::span<const std::byte> bytes, const std::string& name);
Image read_png(const std::string& path);

struct ImageDifference {
  double rms = 0;     ///< of the channels, 0..255
  int maximum = 0;    ///< largest difference of one channel
  size_t pixels = 0;  ///< pixels that differ at all
};
/// Throws Error(usage) when the sizes differ.
ImageDifference compare(const Image& a, const Image& b);

}  // namespace sg
