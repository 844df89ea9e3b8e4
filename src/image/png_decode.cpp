// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <png.h>

#include <algorithm>
#include <csetjmp>

#include "base/bytes.h"
#include "base/error.h"
#include "base/file/file.h"
#include "image/codec.h"

namespace sg {
namespace {

constexpr size_t text_bytes = size_t(64) << 20, most_texts = 1000;

struct Source {
  std::span<const std::byte> bytes;
  size_t at = 0;
  std::string problem;
};

void read_bytes(png_structp png, png_bytep to, png_size_t n) {
  Source& s = *static_cast<Source*>(png_get_io_ptr(png));
  if (n > s.bytes.size() - s.at) png_error(png, "the file is cut off");
  std::memcpy(to, s.bytes.data() + s.at, n);
  s.at += n;
}

void on_error(png_structp png, png_const_charp what) {
  static_cast<Source*>(png_get_error_ptr(png))->problem = what;
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

/// All that must outlive a longjmp lives here, outside the frame that is left by it.
struct Reader {
  Source source;
  png_structp png = nullptr;
  png_infop info = nullptr;
  Image image;
  std::vector<png_bytep> rows;

  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }

  /// Chunks of text in the file: each may unpack to a thousand times its size.
  size_t texts() const {
    size_t n = 0;
    for (size_t at = 8; at + 12 <= source.bytes.size();) {
      const auto* p = reinterpret_cast<const unsigned char*>(source.bytes.data()) + at;
      const std::string_view type(reinterpret_cast<const char*>(p) + 4, 4);
      n += type == "tEXt" || type == "zTXt" || type == "iTXt";
      at += 12 + (size_t(p[0]) << 24 | size_t(p[1]) << 16 | size_t(p[2]) << 8 | size_t(p[3]));
    }
    return n;
  }

  /// False after an error; its text is in source.problem.
  bool read_head() {
    if (setjmp(png_jmpbuf(png))) return false;
    png_set_read_fn(png, &source, read_bytes);
    png_set_user_limits(png, 1 << 20, 1 << 20);
    const size_t n = texts();
    png_set_chunk_cache_max(png, most_texts);
    png_set_chunk_malloc_max(png, text_bytes / std::clamp<size_t>(n, 1, most_texts));
    png_read_info(png, info);
    if (png_get_bit_depth(png, info) == 16) png_set_scale_16(png);
    png_set_expand(png);  // palettes, fewer bits, transparent colours
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    image.width = int(png_get_image_width(png, info));
    image.height = int(png_get_image_height(png, info));
    image.channels = int(png_get_channels(png, info));
    return true;
  }

  bool read_pixels() {
    if (setjmp(png_jmpbuf(png))) return false;
    png_read_image(png, rows.data());
    png_read_end(png, info);
    return true;
  }
};

std::string utf8_of_latin1(std::string_view s) {
  std::string out;
  for (char ch : s) {
    const auto c = uint8_t(ch);
    if (c < 0x80) out += ch;
    else out += char(0xC0 | c >> 6), out += char(0x80 | (c & 0x3F));
  }
  return out;
}

}  // namespace

Image decode_png(std::span<const std::byte> bytes, const std::string& name) {
  if (bytes.size() < 8 || png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, 8)) fail_data("this is not a PNG file", name);
  Reader r;
  r.source.bytes = bytes;
  r.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &r.source, on_error, on_warning);
  r.info = r.png ? png_create_info_struct(r.png) : nullptr;
  if (!r.info) fail_internal("cannot start libpng", name);
  if (!r.read_head()) fail_data("damaged PNG: " + r.source.problem, name);

  // Deflate packs at most 1032 to 1: a larger picture cannot be in this file.
  const size_t row = png_get_rowbytes(r.png, r.info);
  uint64_t size = 0, packed = 0;
  if (!multiply(row, uint64_t(r.image.height), size) || !multiply(bytes.size(), 8 * 1040, packed) || size > packed)
    fail_data(fmt::format("damaged PNG: {} x {} pixels do not fit into {} bytes", r.image.width, r.image.height, bytes.size()), name);
  if (size > (uint64_t(256) << 20) + 100 * uint64_t(bytes.size()))
    fail_data(
        fmt::format("{} x {} pixels from a file of {} bytes would fill {} MiB", r.image.width, r.image.height, bytes.size(), size >> 20),
        name);
  r.image.pixels.resize(size_t(size));
  for (int y = 0; y < r.image.height; ++y) r.rows.push_back(r.image.pixels.data() + size_t(y) * row);
  if (!r.read_pixels()) fail_data("damaged PNG: " + r.source.problem, name);

  png_textp texts = nullptr;
  int count = 0;
  png_get_text(r.png, r.info, &texts, &count);
  for (int i = 0; i < count; ++i) {
    const bool utf8 = texts[i].compression == PNG_ITXT_COMPRESSION_NONE || texts[i].compression == PNG_ITXT_COMPRESSION_zTXt;
    const std::string_view text(texts[i].text ? texts[i].text : "", utf8 ? texts[i].itxt_length : texts[i].text_length);
    r.image.text.emplace_back(texts[i].key, utf8 ? std::string(text) : utf8_of_latin1(text));
  }
  return std::move(r.image);
}

Image read_png(const std::string& path) {
  const MappedFile file(path);
  return decode_png({file.data(), file.size()}, path);
}

}  // namespace sg
