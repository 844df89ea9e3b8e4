// SPDX-License-Identifier: Apache-2.0
#include "image/codec.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include <turbojpeg.h>
#include <webp/encode.h>

#include "base/error.h"
#include "base/file/file.h"

namespace sg {
namespace {

/// RGB or RGBA, grey spread over the three.
Image with_channels(const Image& image, int channels) {
  Image out(image.width, image.height, channels);
  const bool grey = image.channels <= 2, alpha = image.channels % 2 == 0;
  const size_t n = size_t(image.width) * size_t(image.height), in = size_t(image.channels), to = size_t(channels);
  for (size_t i = 0; i < n; ++i) {
    const uint8_t* p = &image.pixels[i * in];
    for (size_t c = 0; c < 3; ++c) out.pixels[i * to + c] = p[grey ? 0 : c];
    if (channels == 4) out.pixels[i * to + 3] = alpha ? p[in - 1] : 255;
  }
  return out;
}

/// Over white, blended in linear light: for formats without alpha.
Image on_white(const Image& image) {
  Image out = with_channels(image, 3);
  if (image.channels % 2) return out;
  const size_t in = size_t(image.channels);
  for (size_t i = 0; i < out.pixels.size(); ++i) {
    const float a = float(image.pixels[i / 3 * in + in - 1]) / 255;
    if (a < 1) out.pixels[i] = uint8_t(255 * srgb_encode(a * srgb_decode(float(out.pixels[i]) / 255) + (1 - a)) + 0.5f);
  }
  return out;
}

std::string webp_bytes(const Image& image, const std::string& path) {
  if (image.width > WEBP_MAX_DIMENSION || image.height > WEBP_MAX_DIMENSION)
    fail_usage(fmt::format("{} x {} pixels are too many for WebP", image.width, image.height), path,
               fmt::format("at most {} along each side; PNG has no such limit", WEBP_MAX_DIMENSION));
  WebPConfig config;
  WebPPicture picture;
  if (!WebPConfigInit(&config) || !WebPPictureInit(&picture) || !WebPConfigLosslessPreset(&config, 2))
    fail_internal("cannot start libwebp", path);
  config.exact = 1;
  picture.use_argb = 1;
  picture.width = image.width, picture.height = image.height;
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  const bool alpha = image.channels % 2 == 0;
  const Image colors = with_channels(image, alpha ? 4 : 3);
  const bool imported = alpha ? WebPPictureImportRGBA(&picture, colors.pixels.data(), 4 * image.width)
                              : WebPPictureImportRGB(&picture, colors.pixels.data(), 3 * image.width);
  const bool good = imported && WebPEncode(&config, &picture);
  std::string bytes(reinterpret_cast<const char*>(writer.mem), good ? writer.size : 0);
  const int problem = picture.error_code;
  WebPPictureFree(&picture);
  WebPMemoryWriterClear(&writer);
  if (!good) fail_data(fmt::format("cannot encode WebP (libwebp error {})", problem), path);
  return bytes;
}

std::string png_bytes(const Image& image, const std::string&) {
  const std::vector<uint8_t> bytes = encode_png(image);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
std::string jpeg_bytes(const Image& image, const std::string&) { return encode_jpeg(image, 92); }

struct ImageFormat {
  std::string_view extension;
  std::string (*encode)(const Image& image, const std::string& path);
};
constexpr ImageFormat image_formats[] = {{"png", png_bytes}, {"jpg", jpeg_bytes}, {"jpeg", jpeg_bytes}, {"webp", webp_bytes}};

}  // namespace

std::string encode_jpeg(const Image& image, int quality) {
  const Image rgb = on_white(image);
  tjhandle tj = tjInitCompress();
  unsigned char* data = nullptr;
  unsigned long size = 0;
  const bool good = tj && tjCompress2(tj, rgb.pixels.data(), rgb.width, 0, rgb.height, TJPF_RGB, &data, &size, TJSAMP_444, quality, 0) == 0;
  const std::string problem = good ? "" : tjGetErrorStr2(tj);
  std::string bytes(reinterpret_cast<const char*>(data), good ? size : 0);
  tjFree(data);
  if (tj) tjDestroy(tj);
  if (!good) fail_data("cannot encode JPEG: " + problem);
  return bytes;
}

const std::vector<std::string>& image_extensions() {
  static const std::vector<std::string> extensions = [] {
    std::vector<std::string> all;
    for (const ImageFormat& f : image_formats) all.emplace_back(f.extension);
    return all;
  }();
  return extensions;
}

std::string encode_image(const std::string& path, const Image& image) {
  const std::string extension = extension_of(path);
  const ImageFormat* format = nullptr;
  for (const ImageFormat& f : image_formats)
    if (f.extension == extension) format = &f;
  if (!format)
    fail_usage(extension.empty() ? "the picture's name has no extension" : fmt::format("cannot write pictures as '.{}'", extension), path,
               "use .png, .jpg or .webp");
  if (image.width < 1 || image.height < 1) fail_usage("the picture has no pixels", path);
  return format->encode(image, path);
}

void write_image(const std::string& path, const Image& image) { write_file(path, encode_image(path, image)); }

ImageDifference compare(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height)
    fail_usage(fmt::format("pictures of {} x {} and {} x {} pixels cannot be compared", a.width, a.height, b.width, b.height), "compare");
  if (a.channels != b.channels) return compare(with_channels(a, 4), with_channels(b, 4));
  ImageDifference d;
  double sum = 0;
  const size_t n = size_t(a.width) * size_t(a.height), channels = size_t(a.channels);
  for (size_t i = 0; i < n; ++i) {
    int most = 0;
    for (size_t c = 0; c < channels; ++c) {
      const int difference = std::abs(int(a.pixels[i * channels + c]) - int(b.pixels[i * channels + c]));
      most = std::max(most, difference);
      sum += double(difference) * difference;
    }
    d.maximum = std::max(d.maximum, most);
    d.pixels += most > 0;
  }
  if (n) d.rms = std::sqrt(sum / double(n * channels));
  return d;
}

}  // namespace sg
