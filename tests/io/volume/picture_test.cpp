// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <png.h>

#include "data/lattice.h"
#include "data/lattice_crop.h"
#include "image/codec.h"
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

namespace {

Image gradient(int channels, int seed) {
  Image m(7, 5, channels);
  for (size_t i = 0; i < m.pixels.size(); ++i) m.pixels[i] = uint8_t(i * 5 + size_t(seed));
  return m;
}

// A grey PNG of 16 bits: 1000 * row from the top + column.
std::string png_16() {
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep b, size_t n) { static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(b), n); },
      nullptr);
  png_set_IHDR(png, info, 3, 2, 16, PNG_COLOR_TYPE_GRAY, 0, 0, 0);
  png_write_info(png, info);
  for (int y = 0; y < 2; ++y) {
    png_byte row[6];
    for (int x = 0; x < 3; ++x) row[2 * x] = png_byte((1000 * y + x) >> 8), row[2 * x + 1] = png_byte(1000 * y + x);
    png_write_row(png, row);
  }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return out;
}

// An uncompressed TIFF of `pages` pages of 3 x 2 numbers: 100 * page + 10 * row from the top + column (+ sample).
struct Tiff {
  bool big = false;
  int bits = 16, format = 1, samples = 1, pages = 1, planar = 1, orientation = 1, rows = 2;
  std::string number(double v) const {
    std::string s(size_t(bits) / 8, '\0');
    uint64_t raw = 0;
    if (format == 3 && bits == 32) raw = std::bit_cast<uint32_t>(float(v));
    else if (format == 3) raw = std::bit_cast<uint64_t>(v);
    else raw = uint64_t(int64_t(v));
    for (size_t i = 0; i < s.size(); ++i) s[big ? s.size() - 1 - i : i] = char(raw >> (8 * i));
    return s;
  }
  std::string word(uint64_t v, int bytes) const {
    std::string s;
    for (int i = 0; i < bytes; ++i) s += char(v >> (8 * (big ? bytes - 1 - i : i)) & 255);
    return s;
  }
  std::string file() const {
    std::string out = (big ? "MM" : "II") + word(42, 2) + word(8, 4);
    for (int p = 0; p < pages; ++p) {
      const size_t plane = size_t(3 * 2 * bits / 8), strips = planar == 2 ? size_t(samples) : 1, tags = 12;
      const size_t data = out.size() + 2 + 12 * tags + 4, lists = data + plane * size_t(samples);
      auto tag = [&](int id, int type, size_t count, uint64_t v) {
        return word(uint64_t(id), 2) + word(uint64_t(type), 2) + word(count, 4) +
               (type == 3 && count == 1 ? word(v, 2) + word(0, 2) : word(v, 4));
      };
      const size_t strip_bytes = planar == 2 ? plane : plane * size_t(samples);
      out += word(tags, 2) + tag(256, 4, 1, 3) + tag(257, 4, 1, uint64_t(rows));
      out += tag(258, 3, 1, uint64_t(bits)) + tag(259, 3, 1, 1) + tag(262, 3, 1, samples == 3 ? 2 : 1);
      out += tag(273, 4, strips, strips > 1 ? lists : data) + tag(274, 3, 1, uint64_t(orientation)) + tag(277, 3, 1, uint64_t(samples));
      out += tag(278, 4, 1, uint64_t(rows)) + tag(279, 4, strips, strips > 1 ? lists + 4 * strips : strip_bytes) +
             tag(284, 3, 1, uint64_t(planar));
      out += tag(339, 3, 1, uint64_t(format));
      const size_t next = lists + (strips > 1 ? 8 * strips : 0);
      out += word(p + 1 < pages ? next : 0, 4);
      auto value = [&](int y, int x, int c) { return number(100 * p + 10 * y + x + c - (format == 2 ? 50 : 0)); };
      if (planar == 2) {
        for (int c = 0; c < samples; ++c)
          for (int i = 0; i < 6; ++i) out += value(i / 3, i % 3, c);
      } else {
        for (int i = 0; i < 6; ++i)
          for (int c = 0; c < samples; ++c) out += value(i / 3, i % 3, c);
      }
      if (strips > 1) {
        for (size_t s = 0; s < strips; ++s) out += word(data + s * plane, 4);
        for (size_t s = 0; s < strips; ++s) out += word(plane, 4);
      }
    }
    return out;
  }
};

double pixel_value(const DatasetPtr& d, size_t i, int c = 0) { return d->fields()[0].array.get(i, c); }

}  // namespace

TEST_CASE("picture: PNG pixels stand upright, in 8 and 16 bits") {
  for (const int channels : {1, 2, 3, 4}) {
    const Image m = gradient(channels, 0);
    write_image(temp_folder() + "p.png", m);
    const auto d = read_file(temp_folder() + "p.png");
    CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{7, 5, 1});
    CHECK(d->fields()[0].name == "PNGImage");
    for (int c = 0; c < channels; ++c) CHECK(pixel_value(d, 0, c) == *(m.at(0, 4) + c));
    CHECK(pixel_value(d, 7 * 4 + 6) == *m.at(6, 0));
  }
  const auto d = read_text("q.png", png_16());
  CHECK(d->fields()[0].array.type() == ElementType::u16);
  CHECK(pixel_value(d, 1) == 1001);
  CHECK(pixel_value(d, 5) == 2);
  ReadOptions o;
  o.region.lo = {1, 1, 0};
  CHECK(pixel_value(read_text("q.png", png_16(), o), 1) == 2);
}

TEST_CASE("picture: JPEG pixels stand upright") {
  Image m(16, 16, 3);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) m.at(x, y)[0] = m.at(x, y)[1] = m.at(x, y)[2] = uint8_t(y < 8 ? 240 : 20);
  write_image(temp_folder() + "p.jpg", m);
  const auto d = read_file(temp_folder() + "p.jpg");
  CHECK(d->fields()[0].components() == 3);
  CHECK(pixel_value(d, 0) < 40);
  CHECK(pixel_value(d, 255) > 220);
}

TEST_CASE("picture: TIFF in every number type, byte order and arrangement") {
  struct Kind {
    int bits, format;
    ElementType type;
  };
  for (const Kind& k : {Kind{8, 1, ElementType::u8},
                        {16, 1, ElementType::u16},
                        {32, 1, ElementType::u32},
                        {8, 2, ElementType::i8},
                        {16, 2, ElementType::i16},
                        {32, 2, ElementType::i32},
                        {32, 3, ElementType::f32},
                        {64, 3, ElementType::f64}})
    for (const bool big : {false, true})
      for (const int planar : {1, 2}) {
        Tiff t;
        t.bits = k.bits, t.format = k.format, t.big = big, t.planar = planar, t.samples = planar == 2 ? 3 : 1;
        const auto d = read_text("t.tif", t.file());
        CHECK(d->fields()[0].array.type() == k.type);
        CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{3, 2, 1});
        const int shift = k.format == 2 ? -50 : 0;
        CHECK(pixel_value(d, 0) == 10 + shift);
        CHECK(pixel_value(d, 5) == 2 + shift);
        if (planar == 2) CHECK(pixel_value(d, 1, 2) == 13 + shift);
      }
  Tiff t;
  t.orientation = 4;  // the first row is the lowest
  CHECK(pixel_value(read_text("t.tif", t.file()), 0) == 0);
}

TEST_CASE("picture: pages of a TIFF are layers, and a region reads only its own") {
  Tiff t;
  t.pages = 4;
  const std::string path = temp_file("t.tif", t.file());
  const auto d = read_file(path);
  CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{3, 2, 4});
  CHECK(pixel_value(d, 6 * 3) == 310);
  ReadOptions o;
  o.region.lo = {1, 0, 1};
  o.region.stride = {1, 1, 2};
  const auto p = read_file(path, o), want = crop_lattice(*d, o.region.lo, o.region.hi, o.region.stride);
  CHECK(lattice_dims(p->mesh()) == lattice_dims(want->mesh()));
  CHECK(same_array(p->fields()[0].array, want->fields()[0].array));
}

TEST_CASE("picture: a folder of pictures is a volume, in the order of the numbers in their names") {
  const std::string path = empty_folder("stack");
  for (const int k : {1, 2, 10, 3}) write_image(path + fmt::format("/s{}.png", k), gradient(1, k));
  write_file(path + "/readme.txt", "words");
  const auto d = with_threads(1, [&] { return read_file(path); });
  CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{7, 5, 4});
  const int order[] = {1, 2, 3, 10};
  for (size_t k = 0; k < 4; ++k) CHECK(pixel_value(d, 35 * k) == *gradient(1, order[k]).at(0, 4));
  CHECK(same_array(d->fields()[0].array, with_threads(8, [&] { return read_file(path); })->fields()[0].array));
  ReadOptions o;
  o.region.lo = {2, 1, 1};
  o.region.stride = {2, 1, 2};
  const auto p = read_file(path, o), want = crop_lattice(*d, o.region.lo, o.region.hi, o.region.stride);
  CHECK(same_array(p->fields()[0].array, want->fields()[0].array));
  write_image(path + "/s11.png", Image(3, 3, 1));
  CHECK(contains(error_of([&] { read_file(path); }), "differ in size"));
  write_image(path + "/s11.png", gradient(3, 0));
  CHECK(contains(error_of([&] { read_file(path); }), "size or type"));
  const std::string tiffs = empty_folder("tiffs");
  Tiff t;
  for (int k = 0; k < 3; ++k) write_file(tiffs + fmt::format("/{}.tif", k), t.file());
  CHECK(lattice_dims(read_file(tiffs)->mesh()) == std::array<size_t, 3>{3, 2, 3});
  t.pages = 2;
  for (int k = 0; k < 3; ++k) write_file(tiffs + fmt::format("/{}.tif", k), t.file());
  CHECK(contains(error_of([&] { read_file(tiffs); }), "2 layers"));
}

TEST_CASE("picture: damaged pictures are refused") {
  Tiff t;
  t.rows = 2000000000;
  CHECK(contains(refusal("b.tif", t.file()), "do not fit into"));
  t.rows = 2;
  t.bits = 64, t.format = 2;
  CHECK(read_text("b.tif", t.file())->fields()[0].array.type() == ElementType::i64);
  t.bits = 16, t.format = 3;
  CHECK(contains(refusal("b.tif", t.file()), "16 bits are not supported"));
  t.format = 1;
  CHECK(cut_and_damage("cut.tif", t.file()) >= 60);
  write_image(temp_folder() + "p.png", gradient(3, 0));
  CHECK(cut_and_damage("cut.png", std::string(MappedFile(temp_folder() + "p.png").text())) >= 60);
  write_image(temp_folder() + "p.jpg", gradient(3, 0));
  CHECK(cut_and_damage("cut.jpg", std::string(MappedFile(temp_folder() + "p.jpg").text())) >= 40);
}
