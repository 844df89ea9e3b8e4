// SPDX-License-Identifier: Apache-2.0
// Films, decoded again by the library.
#include "io/film/movie.h"

#include <vpx/vp8dx.h>
#include <vpx/vpx_decoder.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "base/file/file.h"
#include "base/parallel.h"
#include "support/test.h"

using namespace sg;

namespace {

// A disc that moves over a coloured ground.
Image frame(int w, int h, int n) {
  Image image(w, h, 3);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      uint8_t* p = image.at(x, y);
      const bool disc = std::hypot(x - 20 - 3 * n, y - h / 2) < 12;
      p[0] = disc ? 220 : uint8_t(40 + 120 * x / w), p[1] = disc ? 60 : uint8_t(30 + 150 * y / h), p[2] = disc ? 40 : 110;
    }
  return image;
}

std::string film(const std::string& path, int w, int h, int count, int threads) {
  set_thread_count(threads);
  MovieSettings settings;
  settings.fps = 10;
  MovieWriter writer(path, settings);
  for (int n = 0; n < count; ++n) writer.add(frame(w, h, n));
  writer.finish();
  set_thread_count(0);
  return std::string(MappedFile(path).text());
}

// The contents of all simple blocks, in order.
void blocks(std::string_view s, std::vector<std::string_view>& out) {
  size_t at = 0;
  const auto vint = [&](bool keep) {
    const auto first = uint8_t(s[at]);
    const int length = std::countl_zero(first) + 1;
    uint64_t v = keep ? first : first & (0xFF >> length);
    for (int i = 1; i < length; ++i) v = v << 8 | uint8_t(s[at + size_t(i)]);
    at += size_t(length);
    return v;
  };
  while (at < s.size()) {
    const uint64_t id = vint(true), size = vint(false);
    const std::string_view content = s.substr(at, size);
    if (id == 0x18538067 || id == 0x1F43B675) blocks(content, out);
    if (id == 0xA3) out.push_back(content.substr(4));
    at += size;
  }
}

}  // namespace

TEST_CASE("movie: decoded pictures are those that were given") {
  const int w = 161, h = 99, count = 40;  // odd: the film has a column and a row more
  const std::string file = film(test::temp_folder() + "a.webm", w, h, count, 2);
  std::vector<std::string_view> packets;
  blocks(file, packets);
  REQUIRE(packets.size() == size_t(count));
  vpx_codec_ctx_t decoder{};
  REQUIRE(vpx_codec_dec_init(&decoder, vpx_codec_vp9_dx(), nullptr, 0) == VPX_CODEC_OK);
  int n = 0;
  for (const std::string_view p : packets) {
    REQUIRE(vpx_codec_decode(&decoder, reinterpret_cast<const uint8_t*>(p.data()), unsigned(p.size()), nullptr, 0) == VPX_CODEC_OK);
    vpx_codec_iter_t at = nullptr;
    while (const vpx_image_t* got = vpx_codec_get_frame(&decoder, &at)) {
      CHECK(got->d_w == 162);
      CHECK(got->d_h == 100);
      // Back to colours, BT.709 in limited range.
      const Image given = frame(w, h, n++);
      double square = 0;
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          const double l = (got->planes[0][y * got->stride[0] + x] - 16) * 255.0 / 219;
          const double b = (got->planes[1][y / 2 * got->stride[1] + x / 2] - 128) * 255.0 / 224;
          const double r = (got->planes[2][y / 2 * got->stride[2] + x / 2] - 128) * 255.0 / 224;
          const double rgb[3] = {l + 1.5748 * r, l - 0.1873 * b - 0.4681 * r, l + 1.8556 * b};
          for (int c = 0; c < 3; ++c) square += std::pow(std::clamp(rgb[c], 0.0, 255.0) - given.at(x, y)[c], 2);
        }
      CHECK(10 * std::log10(255.0 * 255 / (square / (3.0 * w * h))) > 30);
    }
  }
  CHECK(n == count);
  vpx_codec_destroy(&decoder);
}

TEST_CASE("movie: the same bytes for any number of threads") {
  const std::string one = film(test::temp_folder() + "one.webm", 640, 360, 12, 1),
                    eight = film(test::temp_folder() + "eight.webm", 640, 360, 12, 8);
  CHECK(one == eight);
}

TEST_CASE("movie: .mp4 goes through ffmpeg, and without it there is a hint and no file") {
  const std::string path = test::temp_folder() + "b.mp4", before = std::getenv("PATH");
  ::setenv("PATH", "/no/such/folder", 1);
  {
    MovieWriter writer(path, {});
    CHECK(test::error_of([&] { writer.add(frame(32, 32, 0)); }).find("or write a .webm, which needs no other program") !=
          std::string::npos);
  }
  ::setenv("PATH", before.c_str(), 1);
  CHECK_FALSE(file_exists(path));
  if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) return;
  {
    MovieWriter writer(path, {});
    for (int n = 0; n < 5; ++n) writer.add(frame(161, 99, n));
    writer.finish();
  }
  CHECK(MappedFile(path).text().substr(4, 4) == "ftyp");
  for (const std::string& name : folder_entries(test::temp_folder())) CHECK(name.find("partial") == std::string::npos);
  {
    MovieWriter dropped(test::temp_folder() + "c.mp4", {});
    dropped.add(frame(64, 64, 0));
  }
  for (const std::string& name : folder_entries(test::temp_folder())) CHECK(name.find("c.mp4") == std::string::npos);
}

TEST_CASE("movie: what cannot be written is said before anything is drawn, and nothing is left behind") {
  CHECK(test::error_of([] { MovieWriter(test::temp_folder() + "a.avi", {}); }).find("supported: .webm .gif .mp4") != std::string::npos);
  CHECK(test::error_of([] { MovieWriter("/no/such/folder/a.webm", {}); }).find("/no/such/folder/a.webm") != std::string::npos);
  const std::string path = test::temp_folder() + "never.webm";
  {
    MovieWriter writer(path, {});
    writer.add(frame(32, 32, 0));
    CHECK(test::error_of([&] { writer.add(frame(34, 32, 0)); }).find("all pictures of a film must have the same size") !=
          std::string::npos);
  }
  CHECK_FALSE(file_exists(path));
  MovieWriter empty(path, {});
  CHECK(test::error_of([&] { empty.finish(); }).find("has no pictures") != std::string::npos);
}
