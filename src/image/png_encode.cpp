// SPDX-License-Identifier: Apache-2.0
// PNG (ISO/IEC 15948): rows are filtered and deflated in stripes of fixed size on all threads. A stripe ends with a sync flush, so
// that the stripes, one after the other, are one deflate stream; each is an IDAT chunk of its own.
#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "image/codec.h"

namespace sg {
namespace {

constexpr size_t stripe_bytes = 96 << 10;
constexpr size_t compress_text_above = 1024;

void put_u32(uint8_t* p, uint32_t v) { p[0] = uint8_t(v >> 24), p[1] = uint8_t(v >> 16), p[2] = uint8_t(v >> 8), p[3] = uint8_t(v); }

/// length, type, body, CRC of type and body; `chunk` holds 8 free bytes and then the body.
void seal(std::vector<uint8_t>& chunk, const char* type) {
  put_u32(chunk.data(), uint32_t(chunk.size() - 8));
  std::memcpy(chunk.data() + 4, type, 4);
  const uint32_t crc = uint32_t(crc32_z(0, chunk.data() + 4, chunk.size() - 4));
  chunk.resize(chunk.size() + 4);
  put_u32(chunk.data() + chunk.size() - 4, crc);
}

void add_chunk(std::vector<uint8_t>& out, const char* type, std::string_view body) {
  std::vector<uint8_t> chunk(8 + body.size());
  if (!body.empty()) std::memcpy(chunk.data() + 8, body.data(), body.size());
  seal(chunk, type);
  out.insert(out.end(), chunk.begin(), chunk.end());
}

std::string zlib_packed(std::string_view text) {
  uLongf size = compressBound(uLong(text.size()));
  std::string packed(size, 0);
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(text.data()), uLong(text.size()), 9) != Z_OK)
    fail_internal("zlib could not compress a text entry", "PNG");
  packed.resize(size);
  return packed;
}

bool is_ascii(std::string_view s) {
  return std::all_of(s.begin(), s.end(), [](char c) { return (c >= 32 && c < 127) || c == '\n' || c == '\t'; });
}

bool is_utf8(std::string_view s) {
  for (size_t i = 0; i < s.size();) {
    const auto c = uint8_t(s[i]);
    const size_t more = c < 0x80 ? 0 : c >= 0xC2 && c < 0xE0 ? 1 : c >= 0xE0 && c < 0xF0 ? 2 : c >= 0xF0 && c < 0xF5 ? 3 : 9;
    if (more == 9 || i + more >= s.size()) return false;
    for (size_t k = 1; k <= more; ++k)
      if ((uint8_t(s[i + k]) & 0xC0) != 0x80) return false;
    i += more + 1;
  }
  return true;
}

void add_text(std::vector<uint8_t>& out, const std::string& key, const std::string& text) {
  if (key.empty() || key.size() > 79 || !is_ascii(key))
    fail_usage(fmt::format("'{}' is not a valid name for a text entry in a PNG", key), "PNG", "use 1 to 79 ASCII characters");
  if (text.find('\0') != std::string::npos) fail_usage(fmt::format("text entry '{}' contains a zero byte", key), "PNG");
  const bool packed = text.size() > compress_text_above;
  const std::string name = key + '\0', body = packed ? zlib_packed(text) : text;
  // Bytes that are not UTF-8 can only be Latin-1.
  const bool latin1 = is_ascii(text) || !is_utf8(text);
  if (!latin1) add_chunk(out, "iTXt", name + char(packed) + '\0' + '\0' + '\0' + body);
  else if (packed) add_chunk(out, "zTXt", name + '\0' + body);
  else add_chunk(out, "tEXt", name + body);
}

/// Filter 1: differences to the pixel before.
void filter_sub(const uint8_t* row, uint8_t* out, size_t n, size_t pixel) {
  for (size_t i = 0; i < std::min(pixel, n); ++i) out[i] = row[i];
  for (size_t i = pixel; i < n; ++i) out[i] = uint8_t(row[i] - row[i - pixel]);
}

/// Filter 2: differences to the row above.
void filter_up(const uint8_t* row, const uint8_t* above, uint8_t* out, size_t n) {
  for (size_t i = 0; i < n; ++i) out[i] = uint8_t(row[i] - above[i]);
}

/// Filter 4: differences to whichever of left, above, above left is nearest to left + above - above left.
void filter_paeth(const uint8_t* row, const uint8_t* above, uint8_t* out, size_t n, size_t pixel) {
  for (size_t i = 0; i < std::min(pixel, n); ++i) out[i] = uint8_t(row[i] - above[i]);
  for (size_t i = pixel; i < n; ++i) {
    const int16_t a = row[i - pixel], b = above[i], c = above[i - pixel];
    const int16_t pa = int16_t(std::abs(b - c)), pb = int16_t(std::abs(a - c)), pc = int16_t(std::abs(a + b - 2 * c));
    const int16_t near_bc = pb <= pc ? b : c;
    const int16_t predicted = pa <= pb && pa <= pc ? a : near_bc;
    out[i] = uint8_t(row[i] - predicted);
  }
}

/// Sum of the differences taken as signed bytes: small where a filter predicts well.
uint32_t cost(const uint8_t* filtered, size_t n) {
  uint32_t sum = 0;
  for (size_t i = 0; i < n; ++i) {
    const int v = int8_t(filtered[i]);
    sum += uint32_t(v < 0 ? -v : v);
  }
  return sum;
}

/// Filter byte and filtered bytes of rows [begin, end), each row with the filter of least cost.
std::vector<uint8_t> filtered_rows(const Image& image, size_t begin, size_t end) {
  const size_t pixel = size_t(image.channels), n = size_t(image.width) * pixel;
  std::vector<uint8_t> out((n + 1) * (end - begin)), trial(n);
  const std::vector<uint8_t> zeros(begin == 0 ? n : 0);
  for (size_t y = begin; y < end; ++y) {
    const uint8_t* row = image.pixels.data() + y * n;
    const uint8_t* above = y ? row - n : zeros.data();
    uint8_t* best = out.data() + (y - begin) * (n + 1);
    best[0] = 2;
    filter_up(row, above, best + 1, n);
    uint32_t least = cost(best + 1, n);
    if (least == 0) continue;
    const auto offer = [&](uint8_t filter) {
      const uint32_t c = cost(trial.data(), n);
      if (c >= least) return;
      least = c, best[0] = filter;
      std::memcpy(best + 1, trial.data(), n);
    };
    filter_sub(row, trial.data(), n, pixel);
    offer(1);
    filter_paeth(row, above, trial.data(), n, pixel);
    offer(4);
  }
  return out;
}

struct Stripe {
  std::vector<uint8_t> chunk;  ///< the whole IDAT chunk
  uint32_t adler = 1;
  size_t bytes = 0;
};

Stripe packed_stripe(const Image& image, size_t begin, size_t end, bool last) {
  const std::vector<uint8_t> rows = filtered_rows(image, begin, end);
  Stripe s;
  s.bytes = rows.size();
  s.adler = uint32_t(adler32_z(1, rows.data(), rows.size()));
  z_stream z{};
  if (deflateInit2(&z, 1, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY) != Z_OK) fail_internal("cannot start zlib", "PNG");
  const size_t head = 8 + (begin == 0 ? 2 : 0);
  s.chunk.resize(head + deflateBound(&z, uLong(rows.size())) + 16);
  if (begin == 0) s.chunk[8] = 0x78, s.chunk[9] = 0x01;  // zlib header: window of 32 KiB, fast
  z.next_in = const_cast<Bytef*>(rows.data());
  z.avail_in = uInt(rows.size());
  z.next_out = s.chunk.data() + head;
  z.avail_out = uInt(s.chunk.size() - head);
  const int result = deflate(&z, last ? Z_FINISH : Z_SYNC_FLUSH);
  const bool good = z.avail_in == 0 && z.avail_out > 0 && result == (last ? Z_STREAM_END : Z_OK);
  s.chunk.resize(head + z.total_out);
  deflateEnd(&z);
  if (!good) fail_internal("zlib could not compress", "PNG");
  seal(s.chunk, "IDAT");
  return s;
}

}  // namespace

std::vector<uint8_t> encode_png(const Image& image) {
  if (image.width < 1 || image.height < 1 || image.channels < 1 || image.channels > 4 ||
      image.pixels.size() != size_t(image.width) * size_t(image.height) * size_t(image.channels))
    fail_usage(
        fmt::format("an image of {} x {} pixels and {} channels cannot be written as PNG", image.width, image.height, image.channels),
        "PNG");
  const size_t row = size_t(image.width) * size_t(image.channels) + 1, height = size_t(image.height);
  const size_t rows = std::max<size_t>(1, stripe_bytes / row), count = (height + rows - 1) / rows;
  std::vector<Stripe> stripes(count);
  parallel_for(height, rows, [&](size_t begin, size_t end) { stripes[begin / rows] = packed_stripe(image, begin, end, end == height); });

  std::vector<uint8_t> out{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  size_t total = 256;
  for (const Stripe& s : stripes) total += s.chunk.size();
  out.reserve(total);
  uint8_t head[13] = {};
  put_u32(head, uint32_t(image.width));
  put_u32(head + 4, uint32_t(image.height));
  static constexpr uint8_t color_type[] = {0, 4, 2, 6};
  head[8] = 8, head[9] = color_type[image.channels - 1];
  add_chunk(out, "IHDR", {reinterpret_cast<const char*>(head), sizeof head});
  add_chunk(out, "sRGB", std::string_view("\0", 1));
  uint8_t number[4];
  put_u32(number, 45455);
  add_chunk(out, "gAMA", {reinterpret_cast<const char*>(number), 4});
  for (const auto& [key, text] : image.text) add_text(out, key, text);
  uLong adler = 1;
  for (const Stripe& s : stripes) {
    out.insert(out.end(), s.chunk.begin(), s.chunk.end());
    adler = adler32_combine(adler, s.adler, z_off_t(s.bytes));
  }
  put_u32(number, uint32_t(adler));
  add_chunk(out, "IDAT", {reinterpret_cast<const char*>(number), 4});
  add_chunk(out, "IEND", {});
  return out;
}

}  // namespace sg
