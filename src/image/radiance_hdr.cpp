// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "base/text/text.h"
#include "image/linear_picture.h"

namespace sg {

namespace {

using Rgbe = std::array<uint8_t, 4>;

class HdrReader {
 public:
  HdrReader(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  LinearPicture read() {
    read_header();
    LinearPicture p;
    read_size(p);
    p.pixels.resize(size_t(p.width) * size_t(p.height));
    std::vector<Rgbe> row(size_t(p.width));
    for (int y = 0; y < p.height; ++y) {
      read_row(row);
      Vec3f* to = &p.pixels[size_t(y) * size_t(p.width)];
      for (size_t x = 0; x < row.size(); ++x) to[x] = value_of(row[x]);
    }
    return p;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { fail_data(what, name_); }

  std::string_view line() {
    const size_t begin = at_;
    while (at_ < bytes_.size() && char(bytes_[at_]) != '\n') ++at_;
    if (at_ == bytes_.size()) fail("the header is cut off");
    return {reinterpret_cast<const char*>(bytes_.data()) + begin, at_++ - begin};
  }

  void read_header() {
    const std::string_view first = line();
    if (!first.starts_with("#?")) fail("is not a Radiance picture");
    bool known = false;
    for (std::string_view l = line(); !trim(l).empty(); l = line()) {
      const size_t sign = l.find('=');
      if (sign == l.npos || l[0] == '#') continue;
      const std::string_view key = trim(l.substr(0, sign)), value = trim(l.substr(sign + 1));
      if (key == "FORMAT") {
        if (value != "32-bit_rle_rgbe") fail(fmt::format("has the format '{}'; only 32-bit_rle_rgbe is read", value.substr(0, 40)));
        known = true;
      } else if (key == "EXPOSURE") {
        divide(value, 0, 3);
      } else if (key == "COLORCORR") {
        const auto parts = words(value);
        for (size_t c = 0; c < 3 && c < parts.size(); ++c) divide(parts[c], int(c), int(c) + 1);
      }
    }
    if (!known && !first.starts_with("#?RADIANCE") && !first.starts_with("#?RGBE")) fail("does not say its format");
  }
  // By a stated factor, from one channel to another.
  void divide(std::string_view text, int from, int to) {
    const auto v = parse_double(text);
    if (!v || !(*v > 0 && std::isfinite(*v))) fail(fmt::format("has an exposure of '{}'", text.substr(0, 40)));
    for (int c = from; c < to; ++c) factor_[c] /= *v;
  }

  void read_size(LinearPicture& p) {
    const auto parts = words(line());
    const auto h = parts.size() == 4 ? parse_int(parts[1]) : std::nullopt, w = parts.size() == 4 ? parse_int(parts[3]) : std::nullopt;
    if (!h || !w || parts[0] != "-Y" || parts[2] != "+X") fail("its rows do not run from the top left; only -Y HEIGHT +X WIDTH is read");
    if (*h < 1 || *w < 1 || *h > 32768 || *w > 32768) fail(fmt::format("says that it has {} x {} pixels", *w, *h));
    const double pixels = double(*w) * double(*h), bytes = pixels * sizeof(Vec3f);
    // A run takes 2 bytes for at most 127 values of a channel: 8 bytes for 127 pixels.
    if (pixels > 0x1p26 || (bytes > 0x1p28 && bytes > 200 * double(bytes_.size())))
      fail(fmt::format("says that it has {} x {} pixels, more than a file of {} may hold", *w, *h, human_bytes(bytes_.size())));
    p.width = int(*w), p.height = int(*h);
  }

  uint8_t byte() {
    if (at_ == bytes_.size()) fail("is cut off");
    return uint8_t(bytes_[at_++]);
  }

  void read_row(std::vector<Rgbe>& row) {
    const size_t w = row.size();
    const Rgbe head{byte(), byte(), byte(), byte()};
    if (w < 8 || w > 32767 || head[0] != 2 || head[1] != 2 || head[2] > 127) return read_old_row(head, row);
    if ((size_t(head[2]) << 8 | head[3]) != w) fail("has a row of another length");
    for (size_t c = 0; c < 4; ++c)
      for (size_t x = 0; x < w;) {
        const uint8_t code = byte();
        const size_t n = code > 128 ? size_t(code) - 128 : code;
        if (n == 0 || n > w - x) fail("has a run beyond the end of its row");
        if (code > 128) {
          const uint8_t v = byte();
          for (const size_t end = x + n; x < end; ++x) row[x][c] = v;
        } else {
          for (const size_t end = x + n; x < end; ++x) row[x][c] = byte();
        }
      }
  }

  // Pixel by pixel; 1, 1, 1, n repeats the last one n times, several in a row by further powers of 256.
  void read_old_row(Rgbe pixel, std::vector<Rgbe>& row) {
    size_t x = 0, power = 1;
    for (;;) {
      if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
        const size_t n = size_t(pixel[3]) * power;
        if (x == 0 || n > row.size() - x) fail("has a run beyond the end of its row");
        std::fill_n(row.begin() + ptrdiff_t(x), n, row[x - 1]);
        x += n, power = std::min(power << 8, size_t(1) << 24);
      } else {
        row[x++] = pixel, power = 1;
      }
      if (x == row.size()) return;
      for (uint8_t& v : pixel) v = byte();
    }
  }

  Vec3f value_of(Rgbe p) const {
    if (p[3] == 0) return {};
    const double unit = std::ldexp(1.0, int(p[3]) - (128 + 8));
    Vec3f v;
    // The middle of the step, as the format's authors decode it.
    for (int c = 0; c < 3; ++c) v[c] = float(std::min((p[size_t(c)] + 0.5) * unit * factor_[c], 3e38));
    return v;
  }

  std::span<const std::byte> bytes_;
  const std::string& name_;
  size_t at_ = 0;
  Vec3 factor_{1, 1, 1};
};

}  // namespace

LinearPicture decode_hdr(std::span<const std::byte> bytes, const std::string& name) { return HdrReader(bytes, name).read(); }

}  // namespace sg
