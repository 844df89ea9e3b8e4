// SPDX-License-Identifier: Apache-2.0
#include "image/texture/texture_file.h"

#include <fmt/core.h>
#include <turbojpeg.h>

#include <cstring>
#include <memory>
#include <string_view>

#include "base/error.h"
#include "image/codec.h"

namespace sg {

namespace {

Image decode_jpeg(std::span<const std::byte> file, const std::string& name) {
  const std::unique_ptr<void, int (*)(tjhandle)> tj(tjInitDecompress(), tjDestroy);
  if (!tj) fail_data("cannot start libjpeg", name);
  const auto* bytes = reinterpret_cast<const unsigned char*>(file.data());
  int width = 0, height = 0, sampling = 0, space = 0;
  if (tjDecompressHeader3(tj.get(), bytes, file.size(), &width, &height, &sampling, &space) != 0 || width < 1 || height < 1)
    fail_data(fmt::format("damaged JPEG: {}", tjGetErrorStr2(tj.get())), name);
  if (size_t(width) * size_t(height) * 3 / 4000 > file.size())
    fail_data(fmt::format("damaged JPEG: {} x {} pixels do not fit into {} bytes", width, height, file.size()), name);
  Image out(width, height, 3);
  if (tjDecompress2(tj.get(), bytes, file.size(), out.pixels.data(), width, 0, height, TJPF_RGB, TJFLAG_ACCURATEDCT) != 0)
    fail_data(fmt::format("damaged JPEG: {}", tjGetErrorStr2(tj.get())), name);
  return out;
}

bool starts_with(std::span<const std::byte> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

}  // namespace

double texture_memory(std::span<const std::byte> bytes) {
  double pixels = 0;
  if (starts_with(bytes, "\x89PNG") && bytes.size() >= 24) {
    const auto number = [&](size_t at) {  // big-endian
      double v = 0;
      for (size_t i = at; i < at + 4; ++i) v = v * 256 + double(bytes[i]);
      return v;
    };
    pixels = number(16) * number(20);
  } else if (starts_with(bytes, "\xff\xd8\xff")) {
    const std::unique_ptr<void, int (*)(tjhandle)> tj(tjInitDecompress(), tjDestroy);
    int width = 0, height = 0, sampling = 0, space = 0;
    if (tj && tjDecompressHeader3(tj.get(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), &width, &height, &sampling,
                                  &space) == 0)
      pixels = double(width) * double(height);
  }
  constexpr double of_texel = 16 * 4 / 3.0 + 4;
  return pixels * of_texel;
}

bool is_picture(std::span<const std::byte> bytes) {
  return starts_with(bytes, "\x89PNG") || starts_with(bytes, "\xff\xd8\xff") || starts_with(bytes, "#?");
}

Texture decode_texture(std::span<const std::byte> bytes, const std::string& name, TexelEncoding encoding, bool alpha) {
  if (starts_with(bytes, "\x89PNG")) return Texture::of(decode_png(bytes, name), encoding, alpha);
  if (starts_with(bytes, "\xff\xd8\xff")) return Texture::of(decode_jpeg(bytes, name), encoding, alpha);
  if (starts_with(bytes, "#?")) return Texture::of(decode_hdr(bytes, name));
  fail_data("is no picture that can be drawn on a surface", name, "give a PNG, a JPEG or a Radiance .hdr");
}

}  // namespace sg
