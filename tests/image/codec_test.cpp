// SPDX-License-Identifier: Apache-2.0
#include "image/codec.h"

#include <fmt/core.h>
#include <signal.h>
#include <sys/resource.h>
#include <zlib.h>

#include <cstring>

#include "base/file/file.h"
#include "base/parallel.h"
#include "base/random.h"
#include "support/test.h"

using namespace sg;

namespace {

/// Gradients, flat parts and noise, so that every filter is chosen somewhere.
Image sample(int width, int height, int channels) {
  Image image(width, height, channels);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c) {
        const int flat = 40 * c, gradient = x + 2 * y + 30 * c, noise = int(random_bits(1, uint64_t((y * width + x) * 4 + c)) & 255);
        image.at(x, y)[c] = uint8_t(y % 3 == 0 ? flat : y % 3 == 1 ? gradient : x % 7 ? gradient * y : noise);
      }
  return image;
}

std::span<const std::byte> view(const std::vector<uint8_t>& v) { return std::as_bytes(std::span(v)); }

Image again(const Image& image) { return decode_png(view(encode_png(image)), "memory"); }

uint32_t crc_of(const uint8_t* p, size_t n) {
  uint32_t crc = ~0u;
  for (size_t i = 0; i < n; ++i) {
    crc ^= p[i];
    for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xEDB88320u ^ crc >> 1 : crc >> 1;
  }
  return ~crc;
}

/// signature + chunks with right CRCs
std::vector<uint8_t> png_of(const std::vector<std::pair<std::string, std::vector<uint8_t>>>& chunks) {
  std::vector<uint8_t> out{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  const auto put = [&](uint32_t v) {
    for (int s = 24; s >= 0; s -= 8) out.push_back(uint8_t(v >> s));
  };
  for (const auto& [type, body] : chunks) {
    put(uint32_t(body.size()));
    const size_t at = out.size();
    out.insert(out.end(), type.begin(), type.end());
    out.insert(out.end(), body.begin(), body.end());
    put(crc_of(out.data() + at, out.size() - at));
  }
  return out;
}

}  // namespace

TEST_CASE("png: what is written is read back, for 1 to 4 channels and odd sizes") {
  for (int channels = 1; channels <= 4; ++channels)
    for (const auto& [w, h] : {std::pair{1, 1}, {1, 7}, {7, 1}, {3, 2}, {251, 197}, {640, 480}}) {
      const Image image = sample(w, h, channels), back = again(image);
      INFO(w << " x " << h << " x " << channels);
      CHECK(back.width == w);
      CHECK(back.height == h);
      CHECK(back.channels == channels);
      CHECK(back.pixels == image.pixels);
    }
}

TEST_CASE("png: a row wider than a stripe") {
  const Image image = sample(100001, 3, 3);
  CHECK(again(image).pixels == image.pixels);
}

TEST_CASE("png: texts travel, short and long, ASCII, UTF-8 and Latin-1") {
  Image image = sample(5, 4, 3);
  std::string recipe;
  for (int i = 0; i < 3000; ++i) recipe += fmt::format("step {}: contour field=T values={}\n", i, i * i);
  image.text = {{"sightglass", recipe}, {"Title", "short"}, {"unit", "\u00b5m \u2192 \u03b1"}, {"long unit", ""}, {"empty", ""}};
  for (int i = 0; i < 500; ++i) image.text[3].second += "\u03b1\u03b2\u03b3 ";
  CHECK(again(image).text == image.text);
  const std::vector<uint8_t> bytes = encode_png(image);
  CHECK(bytes.size() < recipe.size());  // packed
  image.text = {{"path", "caf\xe9"}};   // no UTF-8
  CHECK(again(image).text[0].second == "caf\u00e9");
}

TEST_CASE("png: bad text names and empty images are refused") {
  Image image = sample(2, 2, 3);
  image.text = {{"", "x"}};
  CHECK(test::error_of([&] { encode_png(image); }).find("1 to 79") != std::string::npos);
  image.text = {{std::string(80, 'k'), "x"}};
  CHECK(test::error_of([&] { encode_png(image); }).find("1 to 79") != std::string::npos);
  image.text = {{"k", std::string("a\0b", 3)}};
  CHECK(test::error_of([&] { encode_png(image); }).find("zero byte") != std::string::npos);
  CHECK(test::error_of([] { encode_png(Image(0, 3, 3)); }).find("0 x 3") != std::string::npos);
  image = sample(2, 2, 3);
  image.pixels.pop_back();
  CHECK(test::error_of([&] { encode_png(image); }).find("cannot be written as PNG") != std::string::npos);
}

TEST_CASE("png: the same bytes for 1 and 8 threads") {
  const Image image = sample(517, 391, 3);
  set_thread_count(1);
  const auto one = encode_png(image);
  set_thread_count(8);
  CHECK(encode_png(image) == one);
  set_thread_count(0);
}

TEST_CASE("png: the colour space is declared as sRGB") {
  const auto bytes = encode_png(sample(3, 3, 3));
  const std::string text(bytes.begin(), bytes.end());
  CHECK(text.find("sRGB") != std::string::npos);
  CHECK(text.find("gAMA") != std::string::npos);
}

TEST_CASE("png: palettes, few bits, 16 bits and transparent colours become 8 bits") {
  // zlib stream with one stored block
  const auto stored = [](std::vector<uint8_t> raw) {
    uint32_t a = 1, b = 0;
    for (uint8_t v : raw) a = (a + v) % 65521, b = (b + a) % 65521;
    const auto n = uint16_t(raw.size()), m = uint16_t(~n);
    std::vector<uint8_t> z{0x78, 1, 1, uint8_t(n), uint8_t(n >> 8), uint8_t(m), uint8_t(m >> 8)};
    z.insert(z.end(), raw.begin(), raw.end());
    for (uint8_t v : {uint8_t(b >> 8), uint8_t(b), uint8_t(a >> 8), uint8_t(a)}) z.push_back(v);
    return z;
  };
  const auto head = [](uint8_t w, uint8_t h, uint8_t bits, uint8_t type) {
    return std::vector<uint8_t>{0, 0, 0, w, 0, 0, 0, h, bits, type, 0, 0, 0};
  };
  const Image palette = decode_png(
      view(png_of({{"IHDR", head(2, 1, 1, 3)}, {"PLTE", {10, 20, 30, 40, 50, 60}}, {"IDAT", stored({0, 0x40})}, {"IEND", {}}})), "p");
  CHECK(palette.channels == 3);
  CHECK(palette.pixels == std::vector<uint8_t>{10, 20, 30, 40, 50, 60});
  const Image bits = decode_png(view(png_of({{"IHDR", head(4, 1, 2, 0)}, {"IDAT", stored({0, 0x1B})}, {"IEND", {}}})), "b");
  CHECK(bits.pixels == std::vector<uint8_t>{0, 85, 170, 255});
  const Image deep =
      decode_png(view(png_of({{"IHDR", head(1, 1, 16, 2)}, {"IDAT", stored({0, 0xFF, 0xFF, 0x80, 0x80, 0, 0})}, {"IEND", {}}})), "d");
  CHECK(deep.pixels == std::vector<uint8_t>{255, 128, 0});
  const Image key =
      decode_png(view(png_of({{"IHDR", head(2, 1, 8, 0)}, {"tRNS", {0, 7}}, {"IDAT", stored({0, 7, 8})}, {"IEND", {}}})), "k");
  CHECK(key.channels == 2);
  CHECK(key.pixels == std::vector<uint8_t>{7, 0, 8, 255});
}

TEST_CASE("png: damaged files are errors, wherever they are cut or changed") {
  const std::vector<uint8_t> good = encode_png(sample(31, 17, 3));
  for (size_t n = 0; n < good.size() - 12; n += 7) CHECK_THROWS_AS(decode_png(view({good.begin(), good.begin() + long(n)}), "cut"), Error);
  for (size_t i = 8; i < good.size(); i += 3) {
    std::vector<uint8_t> bad = good;
    bad[i] ^= 0x55;
    try {
      const Image image = decode_png(view(bad), "changed");  // an unimportant chunk may be skipped
      CHECK(image.width == 31);
    } catch (const Error& e) {
      CHECK(e.kind() == ErrorKind::data);
    }
  }
  CHECK(test::error_of([] { decode_png(std::as_bytes(std::span("GIF89a......", 12)), "x.png"); }).find("x.png: this is not a PNG") !=
        std::string::npos);
}

TEST_CASE("png: a tiny file that claims a huge picture is refused before memory is taken") {
  const auto bytes = png_of({{"IHDR", {0, 0, 0x80, 0, 0, 0, 0x80, 0, 8, 6, 0, 0, 0}}, {"IDAT", {0x78, 1}}, {"IEND", {}}});
  CHECK(test::error_of([&] { decode_png(view(bytes), "bomb"); }).find("do not fit into") != std::string::npos);
}

TEST_CASE("png: texts of one file unpack to 64 MiB together at most") {
  const auto packed = [](const std::string& key, size_t bytes) {
    const std::string text(bytes, 'a');
    std::vector<uint8_t> z(compressBound(text.size()));
    uLongf n = z.size();
    REQUIRE(compress(z.data(), &n, reinterpret_cast<const Bytef*>(text.data()), text.size()) == Z_OK);
    std::vector<uint8_t> chunk(key.begin(), key.end());
    chunk.push_back(0), chunk.push_back(0);
    chunk.insert(chunk.end(), z.begin(), z.begin() + long(n));
    return chunk;
  };
  const auto bytes_of_texts = [&](int count, size_t each) {
    std::vector<std::pair<std::string, std::vector<uint8_t>>> chunks{{"IHDR", {0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0}}};
    const std::vector<uint8_t> text = packed("key", each);
    for (int i = 0; i < count; ++i) chunks.emplace_back("zTXt", text);
    std::vector<uint8_t> pixel(compressBound(2));
    uLongf n = pixel.size();
    const Bytef raw[2] = {0, 9};
    REQUIRE(compress(pixel.data(), &n, raw, 2) == Z_OK);
    pixel.resize(n);
    chunks.emplace_back("IDAT", pixel), chunks.emplace_back("IEND", std::vector<uint8_t>{});
    const Image image = decode_png(view(png_of(chunks)), "texts");
    CHECK(image.pixels[0] == 9);
    size_t sum = 0;
    for (const auto& [key, text] : image.text) sum += text.size();
    return sum;
  };
  CHECK(bytes_of_texts(2, size_t(1) << 20) == size_t(2) << 20);
  CHECK(bytes_of_texts(20, size_t(8) << 20) <= size_t(64) << 20);
}

TEST_CASE("codec: the extension chooses; files begin with their format's mark") {
  const Image image = sample(64, 48, 4);
  const auto head = [&](const std::string& name) {
    const std::string path = test::temp_folder() + name;
    write_image(path, image);
    return std::string(MappedFile(path).text().substr(0, 12));
  };
  CHECK(head("a.PNG").substr(1, 3) == "PNG");
  CHECK(head("a.jpg").substr(0, 3) == "\xff\xd8\xff");
  CHECK(head("a.jpeg").substr(0, 3) == "\xff\xd8\xff");
  CHECK(head("a.webp").substr(8, 4) == "WEBP");
  CHECK(read_png(test::temp_folder() + "a.PNG").pixels == image.pixels);
  for (int channels = 1; channels <= 3; ++channels)
    for (const char* name : {"b.jpg", "b.webp"}) {
      write_image(test::temp_folder() + name, sample(9, 5, channels));
      CHECK(MappedFile(test::temp_folder() + name).size() > 20);
    }
}

TEST_CASE("codec: unknown extensions and missing folders are errors") {
  const Image image = sample(300, 300, 3);
  CHECK(test::error_of([&] { write_image("a.bmp", image); }).find("'.bmp'") != std::string::npos);
  CHECK(test::error_of([&] { write_image("picture", image); }).find("no extension") != std::string::npos);
  CHECK(test::error_of([&] { write_image(test::temp_folder() + "none/a.png", image); }).find("none/a.png") != std::string::npos);
  CHECK(test::error_of([&] { write_image(test::temp_folder() + "a.jpg", Image()); }).find("no pixels") != std::string::npos);
  CHECK(test::error_of([&] { write_image(test::temp_folder() + "a.webp", Image(20000, 1, 3)); }).find("WebP") != std::string::npos);
  CHECK(test::error_of([] { read_png(test::temp_folder() + "missing.png"); }).find("missing.png") != std::string::npos);
}

TEST_CASE("codec: a disk that fills up is an error and leaves no file") {
  // A limit on the size of files stands in for the full disk: write() fails half way.
  const std::string path = test::temp_folder() + "full.png";
  Image image = sample(300, 300, 3);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = uint8_t(random_bits(2, i));  // 270 kB, not compressible
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  rlimit tight = before;
  tight.rlim_cur = 64 << 10;
  const auto handler = ::signal(SIGXFSZ, SIG_IGN);
  ::setrlimit(RLIMIT_FSIZE, &tight);
  std::string message;
  ErrorKind kind = ErrorKind::internal;
  try {
    write_image(path, image);
  } catch (const Error& e) {
    message = e.what(), kind = e.kind();
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, handler);
  CHECK(message.find("full.png") != std::string::npos);
  CHECK(kind == ErrorKind::data);
  CHECK(!file_exists(path));
}

TEST_CASE("compare: rms, maximum and number of pixels") {
  Image a(4, 2, 3), b(4, 2, 3);
  CHECK(compare(a, b).pixels == 0);
  b.at(1, 1)[0] = 3;
  b.at(2, 0)[2] = 4;
  const ImageDifference d = compare(a, b);
  CHECK(d.pixels == 2);
  CHECK(d.maximum == 4);
  CHECK(d.rms == doctest::Approx(std::sqrt(25.0 / 24)));
  Image opaque(4, 2, 4);
  for (size_t i = 3; i < opaque.pixels.size(); i += 4) opaque.pixels[i] = 255;
  CHECK(compare(a, opaque).maximum == 0);
  CHECK(test::error_of([&] { compare(a, Image(2, 4, 3)); }).find("4 x 2 and 2 x 4") != std::string::npos);
}
