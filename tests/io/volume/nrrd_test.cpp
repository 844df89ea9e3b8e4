// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "io/io_files.h"

#include "data/lattice.h"

using namespace sg;
using namespace sg::test;

namespace {

std::string bytes_of(const std::vector<int16_t>& v, bool big = false) {
  std::string s;
  for (const int16_t x : v) {
    const char lo = char(x & 255), hi = char(x >> 8 & 255);
    s += big ? hi : lo, s += big ? lo : hi;
  }
  return s;
}

std::vector<int16_t> ramp(size_t n) {
  std::vector<int16_t> v(n);
  for (size_t i = 0; i < n; ++i) v[i] = int16_t(int(i * 37 % 1000) - 300);
  return v;
}

bool holds(const Dataset& d, const std::vector<int16_t>& want) {
  const Array& a = d.fields()[0].array;
  if (a.count() * size_t(a.components()) != want.size()) return false;
  for (size_t i = 0; i < a.count(); ++i)
    for (int c = 0; c < a.components(); ++c)
      if (a.get(i, c) != want[i * size_t(a.components()) + size_t(c)]) return false;
  return true;
}

const std::string nrrd_head = "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 3 2\n";

}  // namespace

TEST_CASE("nrrd: raw data of both byte orders, in text, hexadecimal, attached and detached are the same numbers") {
  const auto v = ramp(24);
  CHECK(holds(*read_text("a.nrrd", nrrd_head + "encoding: raw\nendian: little\n\n" + bytes_of(v)), v));
  CHECK(holds(*read_text("a.nrrd", nrrd_head + "encoding: raw\nendian: big\n\n" + bytes_of(v, true)), v));
  CHECK(holds(*read_text("crlf.nrrd", "NRRD0004\r\ntype: int16\r\ndimension: 3\r\nsizes: 4 3 2\r\nencoding: raw\r\nendian: little\r\n\r\n" +
                                          bytes_of(v)),
              v));
  std::string text, hex;
  for (const int16_t x : v) text += std::to_string(x) + (text.size() % 3 ? " " : "\n");
  for (const char c : bytes_of(v, true)) hex += fmt::format("{:02x}{}", int(static_cast<unsigned char>(c)), hex.size() % 5 ? "" : "\n");
  for (const char* e : {"ascii", "text", "txt", "ASCII"})
    CHECK(holds(*read_text("a.nrrd", nrrd_head + "encoding: " + e + "\n\n" + text), v));
  CHECK(holds(*read_text("a.nrrd", nrrd_head + "encoding: hex\nendian: big\n\n" + hex), v));
  temp_file("brick.raw", "header line\n" + bytes_of(v) + "xyz");
  CHECK(holds(*read_text("d.nhdr", nrrd_head + "encoding: raw\nendian: little\nline skip: 1\ndata file: brick.raw\n"), v));
  CHECK(holds(*read_text("d.nhdr", nrrd_head + "encoding: raw\nendian: little\nbyte skip: 12\ndatafile: brick.raw\n"), v));
  CHECK(holds(*read_text("d.nhdr", nrrd_head + "encoding: raw\nendian: little\nbyte skip: -4\ndata file: brick.raw\n"), v));
}

TEST_CASE("nrrd: data in several files by list and by pattern") {
  const auto v = ramp(24);
  const std::string all = bytes_of(v);
  temp_file("slice01.raw", all.substr(0, 24));
  temp_file("slice02.raw", all.substr(24));
  CHECK(holds(*read_text("p.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: slice%02d.raw 1 2 1\n"), v));
  CHECK(holds(*read_text("p.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: slice%02d.raw 1 2 1 2\n"), v));
  CHECK(holds(*read_text("p.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: LIST\nslice01.raw\nslice02.raw\n"), v));
  std::vector<int16_t> turned(v.begin() + 12, v.end());
  turned.insert(turned.end(), v.begin(), v.begin() + 12);
  CHECK(holds(*read_text("p.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: slice%02d.raw 2 1 -1\n"), turned));
  CHECK(contains(refusal("p.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: LIST\nslice01.raw\n"), "too short"));
  CHECK(contains(refusal("p.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: slice%02d.raw 1 3 1\n"), "3 data files"));
  CHECK(contains(refusal("p.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: slice%s.raw 1 3 1\n"), "not a pattern"));
  CHECK(contains(refusal("p.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: slice%d.raw 1 3 0\n"), "steps of 0"));
  CHECK(contains(refusal("p.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: slice%d.raw 0 2000000000000 1\n"),
                 "files numbered"));
  CHECK(contains(refusal("p.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: slice%d.raw 1 2 -9223372036854775808\n"),
                 "files numbered"));
  CHECK(contains(refusal("p.nhdr", nrrd_head + "encoding: raw\nendian: little\ndata file: nothere.raw\n"), "no such file"));
}

TEST_CASE("nrrd: space directions become spacing, direction and origin") {
  const std::string body = "encoding: ascii\n\n1 2 3 4 5 6 7 8\n";
  auto d = read_text("g.nrrd",
                     "NRRD0004\ntype: float\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\n"
                     "space directions: (0,2,0) (-3,0,0) (0,0,0.5)\nspace origin: (10,20,30)\n" +
                         body);
  const auto* g = d->as<UniformGrid>();
  REQUIRE(g);
  CHECK(g->spacing == Vec3(2, 3, 0.5));
  CHECK(g->origin == Vec3(10, 20, 30));
  CHECK(g->direction.column(0) == Vec3(0, 1, 0));
  CHECK(g->direction.column(1) == Vec3(-1, 0, 0));
  const Lattice lattice(d->mesh());
  CHECK(lattice.view().position(1, 1, 1) == Vec3(7, 22, 30.5));
  REQUIRE(d->notes().size() >= 1);
  CHECK(d->notes().back() == std::pair<std::string, std::string>("space", "left-posterior-superior"));
  // A slice in space: the third axis is completed.
  d = read_text("g.nrrd",
                "NRRD0004\ntype: float\ndimension: 2\nspace dimension: 3\nsizes: 4 2\nspace directions: (0,1,0) (0,0,1)\n" + body);
  g = d->as<UniformGrid>();
  CHECK(g->dims == std::array<size_t, 3>{4, 2, 1});
  CHECK(g->direction.column(2) == Vec3(1, 0, 0));
  // Cells in min..max lie in the middle of their share.
  d = read_text("g.nrrd", "NRRD0003\ntype: float\ndimension: 1\nsizes: 8\naxis mins: 0\naxis maxs: 4\ncenterings: cell\n" + body);
  CHECK(d->as<UniformGrid>()->spacing.x == 0.5);
  CHECK(d->as<UniformGrid>()->origin.x == 0.25);
  d = read_text("g.nrrd", "NRRD0003\ntype: float\ndimension: 1\nsizes: 8\nspacings: NaN\n" + body);
  CHECK(d->as<UniformGrid>()->spacing.x == 1);
}

TEST_CASE("nrrd: axes that are no space become components, wherever they stand") {
  const std::string six = "encoding: ascii\n\n1 2 3 4 5 6 7 8 9 10 11 12\n";
  auto value = [](const DatasetPtr& d, size_t i, int c) { return d->fields()[0].array.get(i, c); };
  SUBCASE("first") {
    const auto d = read_text("c.nrrd", "NRRD0004\ntype: float\ndimension: 2\nsizes: 3 4\nkinds: 3-vector domain\n" + six);
    CHECK(d->point_count() == 4);
    CHECK(d->fields()[0].role == Role::vectors);
    CHECK(value(d, 1, 2) == 6);
  }
  SUBCASE("last: the numbers stay where they are") {
    const auto d = read_text("c.nrrd", "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 3\nkinds: domain domain list\n" + six);
    CHECK(d->point_count() == 4);
    CHECK(value(d, 1, 0) == 2);
    CHECK(value(d, 1, 2) == 10);
    CHECK_FALSE(d->fields()[0].array.packed());
  }
  SUBCASE("between") {
    const auto d = read_text(
        "c.nrrd", "NRRD0004\ntype: float\ndimension: 3\nspace dimension: 2\nsizes: 2 3 2\nspace directions: (1,0) none (0,1)\n" + six);
    CHECK(d->point_count() == 4);
    CHECK(value(d, 3, 1) == 10);
    CHECK(value(d, 2, 0) == 7);
  }
  SUBCASE("first and last") {
    const auto d = read_text("c.nrrd", "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 3 2\nkinds: complex domain list\n" + six);
    CHECK(d->point_count() == 3);
    CHECK(d->fields()[0].components() == 4);
    CHECK(value(d, 1, 1) == 4);
    CHECK(value(d, 1, 2) == 9);
  }
  SUBCASE("none where no kind says so, however short the first axis") {
    const auto d = read_text("c.nrrd", "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 3 2\n" + six);
    CHECK(d->as<UniformGrid>()->dims == std::array<size_t, 3>{2, 3, 2});
    CHECK(d->fields()[0].components() == 1);
    CHECK(value(d, 11, 0) == 12);
    const std::string bytes(3 * 16 * 20, 'a');
    const auto picture = read_text("p.nrrd", "NRRD0001\ntype: uchar\ndimension: 3\nsizes: 3 16 20\nencoding: raw\n\n" + bytes);
    CHECK(picture->as<UniformGrid>()->dims == std::array<size_t, 3>{16, 20, 1});
    CHECK(picture->fields()[0].role == Role::colors);
    const auto thin = read_text("t.nrrd", "NRRD0001\ntype: uchar\ndimension: 3\nsizes: 3 15 20\nencoding: raw\n\n" + bytes.substr(0, 900));
    CHECK(thin->as<UniformGrid>()->dims == std::array<size_t, 3>{3, 15, 20});
  }
  SUBCASE("a fourth axis without a kind") {
    const auto d = read_text("c.nrrd", "NRRD0004\ntype: float\ndimension: 4\nsizes: 3 2 1 2\nspacings: 1 1 1 1\n" + six);
    CHECK(d->point_count() == 6);
    CHECK(d->fields()[0].components() == 2);
    CHECK(value(d, 0, 1) == 7);
  }
  SUBCASE("the axis without a spacing") {
    const auto d = read_text("c.nrrd", "NRRD0004\ntype: float\ndimension: 2\nsizes: 6 2\nspacings: NaN 0.5\n" + six);
    CHECK(d->point_count() == 2);
    CHECK(d->fields()[0].components() == 6);
    CHECK(d->as<UniformGrid>()->spacing.x == 0.5);
  }
  SUBCASE("symmetric tensors get nine numbers and their mask") {
    const auto d = read_text(
        "c.nrrd",
        "NRRD0004\ntype: float\ndimension: 2\nsizes: 7 1\nkinds: 3D-masked-symmetric-matrix domain\nencoding: ascii\n\n0.5 1 2 3 4 5 6\n");
    const Array& t = d->fields()[0].array;
    CHECK(d->fields()[0].role == Role::tensors);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) CHECK(t.get(0, 3 * r + c) == t.get(0, 3 * c + r));
    CHECK(t.get(0, 4) == 4);
    CHECK(t.get(0, 2) == 3);
    CHECK(d->fields().require("Mask").array.get(0) == 0.5);
  }
}

TEST_CASE("nrrd: writing and reading back gives the same grid, field and notes") {
  DatasetParts p;
  UniformGrid g;
  g.dims = {5, 4, 3};
  g.origin = {0.1, -2e7, 3};
  g.spacing = {0.5, 0.1, 2};
  g.direction.m[0][0] = 0, g.direction.m[1][0] = 1, g.direction.m[0][1] = -1, g.direction.m[1][1] = 0;
  p.mesh = g;
  std::vector<float> v(60 * 3);
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(i) * 0.37f;
  v[7] = std::nanf("");
  p.fields.add({"u", Association::point, Array::from_vector(v, 3), "m/s", Role::vectors});
  p.notes = {{"key one", "two\nlines \\ and: a colon"}, {"space", "left-posterior-superior"}, {"content", "a test"}};
  const auto d = make_dataset(p);
  for (const char* compression : {"none", "gzip"}) {
    CAPTURE(compression);
    WriteOptions o;
    o.compression = value_of_word<Compression>(compression);
    Context context;
    const std::string path = temp_folder() + "w.nrrd";
    write_data(path, d, o, context);
    const auto r = read_file(path);
    const auto* h = r->as<UniformGrid>();
    REQUIRE(h);
    CHECK(h->dims == g.dims);
    CHECK(h->origin == g.origin);
    CHECK(length(h->spacing - g.spacing) < 1e-15);
    CHECK(h->direction == g.direction);
    CHECK(same_array(r->fields()[0].array, d->fields()[0].array));
    CHECK(r->fields()[0].name == "u");
    CHECK(r->fields()[0].unit == "m/s");
    CHECK(r->fields()[0].role == Role::vectors);
    for (const auto& note : p.notes) CHECK(std::find(r->notes().begin(), r->notes().end(), note) != r->notes().end());
    if (std::string(compression) == "none") CHECK(reinterpret_cast<uintptr_t>(r->fields()[0].array.raw()) % 64 == 0);
  }
}

TEST_CASE("nrrd: what cannot be written is said") {
  Context context;
  DatasetParts p;
  p.mesh = RectilinearGrid{Array::from_vector(std::vector<float>{0, 1}),
                           Array::from_vector(std::vector<float>{0, 1}),
                           Array::from_vector(std::vector<float>{0}),
                           {}};
  CHECK(contains(error_of([&] { write_data(temp_folder() + "x.nrrd", make_dataset(p), {}, context); }), "resample"));
  p.mesh = UniformGrid{};
  CHECK(contains(error_of([&] { write_data(temp_folder() + "x.nrrd", make_dataset(p), {}, context); }), "no point field"));
  p.fields.add({"a", Association::point, Array::from_vector(std::vector<float>{1}), "", Role::none});
  CHECK(contains(error_of([&] { write_data(temp_folder() + "x.nhdr", make_dataset(p), {}, context); }), "detached"));
  WriteOptions o;
  o.compression = Compression::lz4;
  CHECK(contains(error_of([&] { write_data(temp_folder() + "x.nrrd", make_dataset(p), o, context); }), "lz4"));
  p.fields.add({"b", Association::point, Array::from_vector(std::vector<float>{2}), "", Role::scalars});
  std::string warning;
  context.on_log = [&](LogLevel, std::string_view s) { warning += s; };
  write_data(temp_folder() + "x.nrrd", make_dataset(p), {}, context);
  CHECK(contains(warning, "leaves out 'a' (points)"));
  CHECK(read_file(temp_folder() + "x.nrrd")->fields()[0].array.get(0) == 2);
}

TEST_CASE("nrrd: bad headers are refused with their line") {
  const std::string ok = "endian: little\n\n" + bytes_of(ramp(24));
  CHECK(contains(refusal("b.nrrd", nrrd_head + "encoding: zip\n" + ok), "line 5: unknown encoding 'zip'"));
  CHECK(contains(refusal("b.nrrd", "NRRD0004\ntype: block\n" + ok), "block"));
  CHECK(contains(refusal("b.nrrd", "NRRD0004\ntype: sixteen\n" + ok), "unknown type 'sixteen'"));
  CHECK(contains(refusal("b.nrrd", "NRRD0004\nsizes: 4 3\n" + ok), "before 'dimension'"));
  CHECK(contains(refusal("b.nrrd", "NRRD0004\ndimension: 99\n" + ok), "'dimension' is '99'"));
  CHECK(contains(refusal("b.nrrd", "NRRD0004\ndimension: 2\nsizes: 4 3 2\n" + ok), "3 entries for 2 axes"));
  CHECK(contains(refusal("b.nrrd", "NRRD0004\ndimension: 2\nsizes: 4 -3\n" + ok), "'-3' is not a valid size"));
  CHECK(contains(refusal("b.nrrd", "NRRD0004\nsome words\n" + ok), "neither 'field: value'"));
  CHECK(contains(refusal("b.nrrd", "NRRD0004\ncolour: red\n" + ok), "unknown field 'colour'"));
  CHECK(contains(refusal("b.nrrd", nrrd_head + ok), "no 'encoding'"));
  CHECK(contains(refusal("b.nrrd", "NRRD0004\ntype: float\nencoding: raw\n" + ok), "no 'dimension'"));
  CHECK(contains(refusal("b.nrrd", nrrd_head + "encoding: raw\n"), "ends inside its header"));
  CHECK(contains(refusal("b.nrrd", nrrd_head + "encoding: raw\nspace directions: (1,0,0) (1,0,0) (0,0,1)\nspace dimension: 3\n" + ok),
                 "coplanar"));
  CHECK(contains(refusal("b.nrrd", nrrd_head + "encoding: raw\nspace directions: (1,0,0) (0,0,0) (0,0,1)\n" + ok), "no length"));
  CHECK(contains(refusal("b.nrrd", nrrd_head + "encoding: raw\nspace: lps\nspace directions: (1,0) (0,0,0) (0,0,1)\n" + ok),
                 "vector of 2 numbers"));
  CHECK(contains(refusal("b.nrrd", nrrd_head + "encoding: raw\nendian: middle\n" + ok), "use little or big"));
}

TEST_CASE("nrrd: sizes are checked before memory is asked for") {
  auto with = [](const std::string& sizes, const std::string& encoding) {
    return "NRRD0004\ntype: double\ndimension: 3\nsizes: " + sizes + "\nencoding: " + encoding + "\nendian: little\n\n0 0 0 0";
  };
  CHECK(contains(refusal("s.nrrd", with("100 100 100", "raw")), "8000000 bytes are needed, but there are 7"));
  CHECK(contains(refusal("s.nrrd", with("4000000000 4000000000 4000000000", "raw")), "too large"));
  CHECK(contains(refusal("s.nrrd", with("1000000 1000000 100", "ascii")), "cannot hold"));
  CHECK(contains(refusal("s.nrrd", with("1000000 1000000 100", "hex")), "cannot hold"));
  CHECK(contains(refusal("s.nrrd", with("1000000 1000000 100", "gzip")), "cannot hold"));
  CHECK(contains(refusal("s.nrrd", with("1000000 1000000 100", "bzip2")), "cannot hold"));
  CHECK(contains(refusal("s.nrrd", with("2 1 1", "gzip")), "damaged"));
  CHECK(contains(refusal("s.nrrd", with("2 1 1", "bz2")), "damaged"));
  CHECK(contains(refusal("s.nrrd", with("2 1 1", "hex")), "cannot hold"));
  CHECK(contains(refusal("s.nrrd", with("5 1 1", "ascii")), "cannot hold"));
  CHECK(contains(refusal("s.nrrd", "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 2\nencoding: ascii\n\n1 256"), "'256' is not a valid u8"));
  CHECK(contains(refusal("s.nrrd", "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 2\nencoding: ascii\n\n1 ten"),
                 "line 7: 'ten' is not a valid u8"));
  CHECK(contains(refusal("s.nrrd", "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 2\nencoding: hex\n\n01 0g"),
                 "'g' is not a hexadecimal digit"));
}

TEST_CASE("nrrd: a stream that unpacks to far more than promised is refused, not unpacked") {
  // 200 MB of zeros in 200 kB behind a header that promises 1000 bytes, with a skip that asks for its end.
  DatasetParts p;
  UniformGrid g;
  g.dims = {200 << 20, 1, 1};
  p.mesh = g;
  std::byte* zeros = nullptr;
  p.fields.add({"z", Association::point, Array::make_raw(ElementType::u8, g.dims[0], 1, &zeros), "", Role::none});
  std::memset(zeros, 0, g.dims[0]);
  Context context;
  WriteOptions o;
  o.compression = Compression::gzip;
  const std::string path = temp_folder() + "bomb.nrrd";
  write_data(path, make_dataset(std::move(p)), o, context);
  const MappedFile file(path);
  const std::string packed(file.text().substr(file.text().find("\n\n") + 2));
  const std::string small = "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 1000\nencoding: gzip\n";
  CHECK(contains(refusal("bomb1.nrrd", small + "byte skip: -1\n\n" + packed), "though the header announces 1000 B"));
}

TEST_CASE("nrrd: cut and damaged files give errors, never crashes") {
  const auto v = ramp(24);
  CHECK(cut_and_damage("cut.nrrd", nrrd_head + "encoding: raw\nendian: little\nspace: lps\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n\n" +
                                       bytes_of(v)) == 63);
  std::string text;
  for (int i = 0; i < 24; ++i) text += std::to_string(i + 100) + " ";
  CHECK(cut_and_damage("cut.nrrd", nrrd_head + "encoding: ascii\n\n" + text) >= 62);
  DatasetParts p;
  UniformGrid g;
  g.dims = {10, 10, 10};
  p.mesh = g;
  std::vector<int16_t> noise(1000);
  for (size_t i = 0; i < noise.size(); ++i) noise[i] = int16_t(i * i * 31);
  p.fields.add({"z", Association::point, Array::from_vector(noise), "", Role::none});
  Context context;
  WriteOptions o;
  o.compression = Compression::gzip;
  write_data(temp_folder() + "gz.nrrd", make_dataset(p), o, context);
  CHECK(cut_and_damage("cut.nrrd", std::string(MappedFile(temp_folder() + "gz.nrrd").text())) == 63);
}

TEST_CASE("nrrd: an axis without length is written with one, as it has a single layer") {
  DatasetParts p;
  UniformGrid g;
  g.dims = {3, 2, 1}, g.spacing = {0.5, 0.5, 0};
  p.mesh = g;
  p.fields.add({"z", Association::point, Array::from_vector(std::vector<float>(6, 1)), "", Role::none});
  Context context;
  write_data(temp_folder() + "flat.nrrd", make_dataset(p), {}, context);
  const DatasetPtr back = read_file(temp_folder() + "flat.nrrd");
  CHECK(std::get<UniformGrid>(back->mesh()).spacing == Vec3(0.5, 0.5, 1));
  CHECK(std::get<UniformGrid>(back->mesh()).dims == g.dims);
}
