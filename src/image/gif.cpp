// SPDX-License-Identifier: Apache-2.0
#include "image/gif.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/error.h"

namespace sg {

namespace {

using Color = std::array<uint8_t, 3>;
constexpr uint8_t unchanged = 0;  // the number of the transparent colour
constexpr size_t most_colors = 255;

void put16(std::string& out, int v) { out += char(v & 255), out += char(v >> 8); }

// Which pixels a picture changes, and the smallest rectangle around them.
struct Change {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  std::vector<bool> pixels;  // of the whole picture
};

Change change_of(const Image& now, const Image& last) {
  const int w = now.width, h = now.height;
  Change c{w, h, 0, 0, std::vector<bool>(size_t(w) * size_t(h), last.pixels.empty())};
  if (last.pixels.empty()) return {0, 0, w, h, std::move(c.pixels)};
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      if (std::equal(now.at(x, y), now.at(x, y) + 3, last.at(x, y))) continue;
      c.pixels[size_t(y) * size_t(w) + size_t(x)] = true;
      c.x0 = std::min(c.x0, x), c.x1 = std::max(c.x1, x + 1), c.y0 = std::min(c.y0, y), c.y1 = std::max(c.y1, y + 1);
    }
  if (c.x0 >= c.x1) c.x0 = c.y0 = 0, c.x1 = c.y1 = 1;  // a picture holds at least one pixel
  return c;
}

// Colours that share the upper six bits of each channel count as one.
constexpr size_t bin_of(const uint8_t* p) { return size_t(p[0] >> 2) << 12 | size_t(p[1] >> 2) << 6 | size_t(p[2] >> 2); }
constexpr size_t bins = size_t(1) << 18;

struct Entry {
  uint32_t bin;
  double count;
  std::array<double, 3> mean;
};

// A range of entries: the sum of squared distances to its mean along the axis where that is largest.
struct Box {
  size_t begin, end;
  int axis = 0;
  double spread = 0, middle = 0;
};

Box box_of(const std::vector<Entry>& entries, size_t begin, size_t end) {
  Box box{begin, end};
  for (int a = 0; a < 3; ++a) {
    double n = 0, sum = 0, squares = 0;
    for (size_t i = begin; i < end; ++i) {
      const double v = entries[i].mean[size_t(a)], c = entries[i].count;
      n += c, sum += c * v, squares += c * v * v;
    }
    if (const double spread = squares - sum * sum / n; spread > box.spread) box.axis = a, box.spread = spread, box.middle = sum / n;
  }
  return box;
}

// The number of each pixel's colour, from 1, and the colours; 0 stands for unchanged ones.
class Palette {
 public:
  Palette(const Image& picture, const Change& change) : number_of_bin_(bins, 0) {
    std::vector<std::array<uint32_t, 4>> sums(bins);
    std::vector<uint32_t> used;
    for (int y = change.y0; y < change.y1; ++y)
      for (int x = change.x0; x < change.x1; ++x) {
        if (!change.pixels[size_t(y) * size_t(picture.width) + size_t(x)]) continue;
        const uint8_t* p = picture.at(x, y);
        auto& s = sums[bin_of(p)];
        if (s[3] == 0) used.push_back(uint32_t(bin_of(p)));
        if (s[3] < (1u << 24)) s[0] += p[0], s[1] += p[1], s[2] += p[2], ++s[3];
      }
    std::sort(used.begin(), used.end());
    std::vector<Entry> entries;
    for (const uint32_t b : used) {
      const auto& s = sums[b];
      entries.push_back({b, double(s[3]), {double(s[0]) / s[3], double(s[1]) / s[3], double(s[2]) / s[3]}});
    }
    cut(entries);
  }
  uint8_t number(const uint8_t* p) const { return number_of_bin_[bin_of(p)]; }
  const std::vector<Color>& colors() const { return colors_; }

 private:
  // Boxes are divided at the mean of their widest axis, the one of the largest spread first.
  void cut(std::vector<Entry>& entries) {
    std::vector<Box> boxes;
    if (!entries.empty()) boxes.push_back(box_of(entries, 0, entries.size()));
    while (boxes.size() < most_colors) {
      const auto widest = std::max_element(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) { return a.spread < b.spread; });
      if (widest == boxes.end() || !(widest->spread > 1e-6)) break;
      const Box box = *widest;
      const auto begin = entries.begin() + std::ptrdiff_t(box.begin), end = entries.begin() + std::ptrdiff_t(box.end);
      const auto middle = std::stable_partition(begin, end, [&](const Entry& e) { return e.mean[size_t(box.axis)] <= box.middle; });
      const auto at = size_t(middle - entries.begin());
      if (at == box.begin || at == box.end) break;
      *widest = box_of(entries, box.begin, at);
      boxes.push_back(box_of(entries, at, box.end));
    }
    for (const Box& box : boxes) {
      double n = 0;
      std::array<double, 3> sum{};
      for (size_t i = box.begin; i < box.end; ++i) {
        n += entries[i].count;
        for (size_t a = 0; a < 3; ++a) sum[a] += entries[i].count * entries[i].mean[a];
        number_of_bin_[entries[i].bin] = uint8_t(colors_.size() + 1);
      }
      colors_.push_back({uint8_t(std::lround(sum[0] / n)), uint8_t(std::lround(sum[1] / n)), uint8_t(std::lround(sum[2] / n))});
    }
  }

  std::vector<uint8_t> number_of_bin_;
  std::vector<Color> colors_;
};

// Codes of nine to twelve bits, lowest bit first, in blocks of at most 255 bytes.
class LzwWriter {
 public:
  explicit LzwWriter(std::string& out) : out_(out) {
    out_ += char(symbol_bits);
    reset();
    put(clear);
  }
  void add(uint8_t symbol) {
    if (prefix_ < 0) {
      prefix_ = symbol;
      return;
    }
    const uint32_t key = uint32_t(prefix_) << 8 | symbol;
    const auto [at, fresh] = slot(key);
    if (!fresh) {
      prefix_ = codes_[at];
      return;
    }
    put(prefix_);
    prefix_ = symbol;
    if (next_ == most_codes) {
      put(clear);
      reset();
      return;
    }
    keys_[at] = key + 1, codes_[at] = next_++;
  }
  void finish() {
    if (prefix_ >= 0) put(prefix_);
    put(stop);
    if (bits_ > 0) block_ += char(pending_ & 255);
    end_block();
    out_ += '\0';
  }

 private:
  static constexpr int symbol_bits = 8, clear = 256, stop = 257, first = 258, most_bits = 12, most_codes = 1 << most_bits;
  static constexpr size_t slots = 1 << 14;

  std::pair<size_t, bool> slot(uint32_t key) const {
    for (size_t at = key * 2654435761u >> 18;; at = (at + 1) % slots)
      if (keys_[at] == 0 || keys_[at] == key + 1) return {at, keys_[at] == 0};
  }
  void reset() {
    keys_.assign(slots, 0), codes_.assign(slots, 0);
    next_ = first, width_ = symbol_bits + 1;
  }
  void put(int code) {
    pending_ |= uint32_t(code) << bits_;
    for (bits_ += width_; bits_ >= 8; bits_ -= 8, pending_ >>= 8) {
      block_ += char(pending_ & 255);
      if (block_.size() == 255) end_block();
    }
    if (next_ >= 1 << width_ && width_ < most_bits) ++width_;  // the reader knows one code less
  }
  void end_block() {
    if (block_.empty()) return;
    out_ += char(block_.size());
    out_ += block_;
    block_.clear();
  }

  std::string& out_;
  std::string block_;
  std::vector<uint32_t> keys_;  // plus 1; 0: free
  std::vector<int> codes_;
  int prefix_ = -1, next_ = first, width_ = symbol_bits + 1, bits_ = 0;
  uint32_t pending_ = 0;
};

}  // namespace

GifWriter::GifWriter(int width, int height, double fps) : width_(width), height_(height), fps_(fps) {
  if (width < 1 || height < 1 || width > 65535 || height > 65535)
    fail_usage(fmt::format("{} x {} pixels are not a size of GIF pictures", width, height), "gif", "sides are 1 to 65535 pixels long");
  bytes_ = "GIF89a";
  put16(bytes_, width), put16(bytes_, height);
  bytes_ += '\x70';        // eight bits a channel; each picture has colours of its own
  bytes_.append(2, '\0');  // background, shape of pixels
  bytes_ += "\x21\xff\x0bNETSCAPE2.0\x03\x01";
  put16(bytes_, 0);  // repeated for ever
  bytes_ += '\0';
}

// In hundredths of a second, so that the whole keeps its pace; shorter ones than two are not shown as such.
int GifWriter::delay() {
  const auto at = [&](size_t n) { return std::llround(double(n) * 100 / fps_); };
  return int(std::clamp<long long>(at(pictures_ + 1) - at(pictures_), 2, 65535));
}

void GifWriter::add(const Image& picture) {
  const Change change = change_of(picture, last_);
  const Palette palette(picture, change);
  bytes_ += "\x21\xf9\x04\x05";  // the picture before stays below; one colour is transparent
  put16(bytes_, delay());
  bytes_ += char(unchanged);
  bytes_ += '\0';
  bytes_ += '\x2c';
  put16(bytes_, change.x0), put16(bytes_, change.y0), put16(bytes_, change.x1 - change.x0), put16(bytes_, change.y1 - change.y0);
  bytes_ += '\x87';  // 256 colours of its own
  std::array<char, 768> table{};
  for (size_t i = 0; i < palette.colors().size(); ++i)
    for (size_t a = 0; a < 3; ++a) table[3 * (i + 1) + a] = char(palette.colors()[i][a]);
  bytes_.append(table.data(), table.size());
  LzwWriter lzw(bytes_);
  for (int y = change.y0; y < change.y1; ++y)
    for (int x = change.x0; x < change.x1; ++x)
      lzw.add(change.pixels[size_t(y) * size_t(width_) + size_t(x)] ? palette.number(picture.at(x, y)) : unchanged);
  lzw.finish();
  last_ = picture;
  ++pictures_;
}

std::string GifWriter::finish() {
  bytes_ += '\x3b';
  return std::move(bytes_);
}

}  // namespace sg
