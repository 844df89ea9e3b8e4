// SPDX-License-Identifier: Apache-2.0
#include "image/gif.h"

#include <cmath>

#include "base/random.h"
#include "support/test.h"

using namespace sg;

namespace {

// Reads what GifWriter writes: the pictures as they are shown, one over the other, and their delays.
struct Gif {
  std::vector<Image> pictures;
  std::vector<int> delays;
};

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}
  Gif read() {
    Gif gif;
    REQUIRE(bytes_.substr(0, 6) == "GIF89a");
    at_ = 6;
    const int width = u16(), height = u16();
    at_ = 13;
    Image shown(width, height, 3);
    for (;;) {
      const int what = u8();
      if (what == 0x3b) break;
      if (what == 0x21) {
        if (u8() == 0xf9) {
          REQUIRE(u8() == 4);
          REQUIRE(u8() == 5);
          gif.delays.push_back(u16());
          REQUIRE(u16() == 0);
        } else {
          while (const int n = u8()) at_ += size_t(n);
        }
        continue;
      }
      REQUIRE(what == 0x2c);
      const int x0 = u16(), y0 = u16(), w = u16(), h = u16();
      REQUIRE(u8() == 0x87);
      const std::string table = bytes_.substr(at_, 768);
      at_ += 768;
      const std::vector<uint8_t> symbols = lzw();
      REQUIRE(symbols.size() == size_t(w) * size_t(h));
      for (size_t i = 0; i < symbols.size(); ++i)
        if (symbols[i] > 0)
          for (int c = 0; c < 3; ++c) shown.at(x0 + int(i) % w, y0 + int(i) / w)[c] = uint8_t(table[3 * size_t(symbols[i]) + size_t(c)]);
      gif.pictures.push_back(shown);
    }
    CHECK(at_ == bytes_.size());
    return gif;
  }

 private:
  int u8() { return uint8_t(bytes_.at(at_++)); }
  int u16() {
    const int low = u8();
    return low | u8() << 8;
  }
  std::vector<uint8_t> lzw() {
    REQUIRE(u8() == 8);
    std::string data;
    while (const int n = u8()) data += bytes_.substr(at_, size_t(n)), at_ += size_t(n);
    std::vector<uint8_t> out;
    std::vector<std::string> codes;
    size_t bit = 0;
    int width = 9, last = -1;
    for (;;) {
      int code = 0;
      for (int i = 0; i < width; ++i, ++bit) code |= (uint8_t(data.at(bit / 8)) >> bit % 8 & 1) << i;
      if (code == 257) break;
      if (code == 256) {
        codes.clear();
        for (int i = 0; i < 258; ++i) codes.emplace_back(1, char(i));
        width = 9, last = -1;
        continue;
      }
      std::string text;
      if (code < int(codes.size())) text = codes[size_t(code)];
      else text = codes.at(size_t(last)) + codes[size_t(last)][0];
      if (last >= 0 && codes.size() < 4096) codes.push_back(codes[size_t(last)] + text[0]);
      for (const char c : text) out.push_back(uint8_t(c));
      last = code;
      if (int(codes.size()) >= 1 << width && width < 12) ++width;
    }
    CHECK(bit > 8 * (data.size() - 1));
    return out;
  }

  const std::string& bytes_;
  size_t at_ = 0;
};

Gif written(const std::vector<Image>& pictures, double fps) {
  GifWriter writer(pictures[0].width, pictures[0].height, fps);
  for (const Image& p : pictures) writer.add(p);
  const std::string bytes = writer.finish();
  return Reader(bytes).read();
}

}  // namespace

TEST_CASE("gif: pictures of few colours come back as they are, changed ones too") {
  for (const auto& [w, h] : {std::pair{1, 1}, {7, 5}, {320, 200}}) {
    std::vector<Image> pictures;
    for (int n = 0; n < 4; ++n) {
      Image p(w, h, 3);
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          const uint64_t r = random_bits(5, uint64_t(x / 2 + 1000 * y)) % 200 + (x > w / 2 && n > 1 ? uint64_t(n) : 0);
          for (int c = 0; c < 3; ++c) p.at(x, y)[c] = uint8_t(c == 0 ? r : c == 1 ? 255 - r : 17 * (r % 15));
        }
      pictures.push_back(p);
    }
    const Gif back = written(pictures, 25);
    REQUIRE(back.pictures.size() == 4);
    for (size_t i = 0; i < 4; ++i) CHECK(back.pictures[i].pixels == pictures[i].pixels);
  }
}

TEST_CASE("gif: of many colours each pixel gets one close to its own, and white stays white") {
  Image p(256, 256, 3);
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x) p.at(x, y)[0] = uint8_t(x), p.at(x, y)[1] = uint8_t(y), p.at(x, y)[2] = uint8_t(255 - (x + y) / 2);
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 128; ++x) std::fill_n(p.at(x, y), 3, uint8_t(255));
  const Gif back = written({p}, 10);
  double worst = 0, sum = 0;
  for (size_t i = 0; i < p.pixels.size(); ++i) {
    const double d = std::abs(double(p.pixels[i]) - double(back.pictures[0].pixels[i]));
    worst = std::max(worst, d), sum += d;
  }
  CHECK(worst <= 24);
  CHECK(sum / double(p.pixels.size()) < 3);
  CHECK(back.pictures[0].at(5, 5)[0] == 255);
  CHECK(back.delays == std::vector<int>{10});
}

TEST_CASE("gif: noise fills the table of codes and begins it anew; delays keep the pace") {
  std::vector<Image> pictures;
  for (int n = 0; n < 5; ++n) {
    Image p(150, 90, 3);
    for (size_t i = 0; i < p.pixels.size() / 3; ++i) std::fill_n(&p.pixels[3 * i], 3, uint8_t(random_bits(uint64_t(n), i) % 64 * 4));
    pictures.push_back(p);
  }
  const Gif back = written(pictures, 30);
  for (size_t i = 0; i < pictures.size(); ++i) CHECK(back.pictures[i].pixels == pictures[i].pixels);
  CHECK(back.delays == std::vector<int>{3, 4, 3, 3, 4});
  CHECK(test::error_of([] { GifWriter(70000, 2, 25); }).find("not a size of GIF pictures") != std::string::npos);
}
