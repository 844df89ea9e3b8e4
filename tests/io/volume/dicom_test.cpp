// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "data/lattice.h"
#include "io/io_files.h"
#include "io/volume/dicom_bytes.h"

using namespace sg;
using namespace sg::test;

namespace {

double dicom_value(const DatasetPtr& d, size_t i, int c = 0) { return d->fields().require("DICOMImage").array.get(i, c); }
std::string note(const DatasetPtr& d, std::string_view key) {
  for (const auto& [k, v] : d->notes())
    if (k == key) return v;
  return "";
}

}  // namespace

TEST_CASE("dicom: implicit, explicit, big endian, run-length and deflated files hold the same numbers") {
  const std::vector<int> v{-5, 0, 7, 300, -300, 32767};
  for (const Syntax s : {Syntax::implicit, Syntax::little, Syntax::big, Syntax::rle, Syntax::deflated}) {
    CAPTURE(int(s));
    SliceOptions o;
    o.syntax = s;
    o.pixels = stored(v, s);
    const auto d = read_text("a.dcm", slice(o));
    CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{3, 2, 1});
    CHECK(d->fields()[0].array.type() == ElementType::i16);
    for (size_t i = 0; i < 6; ++i) CHECK(dicom_value(d, i) == v[i]);
    CHECK(d->as<UniformGrid>()->spacing.x == 0.5);
    CHECK(d->as<UniformGrid>()->spacing.y == 2);
    CHECK(note(d, "Modality") == "CT");
    for (const auto& [k, text] : d->notes()) CHECK(!contains(text, "Doe"));
  }
}

TEST_CASE("dicom: slices are ordered along their normal, wherever they lie in the folder") {
  const std::string path = empty_folder("series");
  // Rows run along y, columns along -x: the normal is (0,0,1) x ... = -z for these axes.
  const double z[] = {30, 10, 20, 40};
  for (int k = 0; k < 4; ++k) {
    SliceOptions o;
    o.orientation = "0\\1\\0\\1\\0\\0";
    o.position = fmt::format("5\\6\\{}", z[k]);
    o.number = k;
    o.pixels = stored({k, 1, 2, 3, 4, 5});
    write_file(path + fmt::format("/f{}", k), slice(o));
  }
  write_file(path + "/notes.txt", "not a picture");
  const auto d = read_file(path);
  CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{3, 2, 4});
  const Lattice lattice(d->mesh());
  const int order[] = {3, 0, 2, 1};  // 40, 30, 20, 10
  for (size_t k = 0; k < 4; ++k) {
    CHECK(dicom_value(d, 6 * k) == order[k]);
    CHECK(length(lattice.view().position(0, 0, k) - Vec3(5, 6, 40 - 10 * double(k))) < 1e-12);
  }
  CHECK(length(lattice.view().position(2, 1, 0) - Vec3(5 + 2, 6 + 1, 40)) < 1e-12);
  CHECK(note(d, "space") == "left-posterior-superior");
  ReadOptions o;
  o.region.lo = {1, 0, 1};
  o.region.hi = {2, 1, 3};
  o.region.stride = {1, 1, 2};
  const auto p = read_file(path, o);
  CHECK(lattice_dims(p->mesh()) == std::array<size_t, 3>{2, 2, 2});
  CHECK(dicom_value(p, 0) == 1);
  CHECK(dicom_value(p, 7) == 5);
  o = {};
  o.header_only = true;
  CHECK(read_file(path, o)->point_count() == 24);
  check_names_alone(path);
}

TEST_CASE("dicom: missing slices and a leaning gantry are reported") {
  const std::string path = empty_folder("gaps");
  for (const int k : {0, 1, 2, 4, 5}) {
    SliceOptions o;
    o.position = fmt::format("0\\{}\\{}", 0.5 * k, 3 * k);
    o.pixels = stored({k, 1, 2, 3, 4, 5});
    write_file(path + fmt::format("/f{}.dcm", k), slice(o));
  }
  Context context;
  std::string warning;
  context.on_log = [&](LogLevel l, std::string_view s) {
    if (l == LogLevel::warning) warning += s;
  };
  const auto d = std::get<DatasetPtr>(read_data(path, {}, context));
  CHECK(contains(warning, "missing at 1 places"));
  CHECK(contains(note(d, "slice distance"), "3 to 6 mm"));
  CHECK(note(d, "shear") != "");
  const Lattice lattice(d->mesh());
  CHECK(length(lattice.view().position(0, 0, 4) - Vec3(0, 2.5, 15)) < 1e-12);
}

TEST_CASE("dicom: slope and intercept, and bits that are not stored") {
  SliceOptions o;
  o.slope = "2", o.intercept = "-1024";
  o.stored = 12;
  o.is_signed = false;
  o.pixels = stored({0, 1, 4095, 0xf001, 5, 6});  // the upper four bits are none of the number's
  auto d = read_text("s.dcm", slice(o));
  CHECK(d->fields()[0].array.type() == ElementType::i16);
  CHECK(dicom_value(d, 0) == -1024);
  CHECK(dicom_value(d, 2) == 2 * 4095 - 1024);
  CHECK(dicom_value(d, 3) == -1022);
  o.slope = "0.5";
  d = read_text("s.dcm", slice(o));
  CHECK(d->fields()[0].array.type() == ElementType::f32);
  CHECK(dicom_value(d, 1) == -1023.5);
  o.slope = "", o.intercept = "";
  o.is_signed = true;
  o.pixels = stored({0x0fff, 0x0800, 0x07ff, 0, 0, 0});
  d = read_text("s.dcm", slice(o));
  CHECK(dicom_value(d, 0) == -1);
  CHECK(dicom_value(d, 1) == -2048);
  CHECK(dicom_value(d, 2) == 2047);
}

TEST_CASE("dicom: colours, by pixel or by plane") {
  SliceOptions o;
  o.samples = 3, o.bits = 8, o.stored = 8, o.is_signed = false;
  o.photometric = "RGB";
  for (int i = 0; i < 18; ++i) o.pixels += char(i);
  auto d = read_text("c.dcm", slice(o));
  CHECK(d->fields()[0].role == Role::colors);
  CHECK(dicom_value(d, 1, 2) == 5);
  o.planar = 1;
  d = read_text("c.dcm", slice(o));
  CHECK(dicom_value(d, 1, 2) == 13);
}

TEST_CASE("dicom: frames of one file are slices; several series and several volumes are parts") {
  SliceOptions o;
  o.frames = 3;
  o.pixels = stored({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17});
  auto d = read_text("m.dcm", slice(o));
  CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{3, 2, 3});
  CHECK(dicom_value(d, 17) == 17);
  const std::string path = empty_folder("two");
  o.frames = 1;
  o.pixels = stored({1, 2, 3, 4, 5, 6});
  for (int k = 0; k < 2; ++k)
    for (const char* series : {"1.5", "1.6"})
      for (int echo = 0; echo < (series[2] == '6' ? 2 : 1); ++echo) {
        o.series = series;
        o.number = 10 * echo + k;
        o.position = fmt::format("0\\0\\{}", k);
        o.pixels[0] = char(echo);
        write_file(path + fmt::format("/{}_{}_{}.dcm", series, k, echo), slice(o));
      }
  Context context;
  const Data data = read_data(path, {}, context);
  const auto& parts = std::get<CollectionPtr>(data)->parts;
  REQUIRE(parts.size() == 3);
  CHECK(parts[0].name == "test 1.5");
  CHECK(parts[2].name == "test 1.6, volume 2");
  CHECK(dicom_value(std::get<DatasetPtr>(parts[2].data), 0) == 1);
}

TEST_CASE("dicom: what cannot be read is said") {
  SliceOptions o;
  o.pixels = stored({1, 2, 3, 4, 5});
  CHECK(contains(refusal("b.dcm", slice(o)), "need 12 bytes, but there are 10"));
  o.pixels = stored({1, 2, 3, 4, 5, 6});
  o.rows = 65535, o.columns = 65535;
  CHECK(contains(refusal("b.dcm", slice(o)), "there are 12"));
  o.syntax = Syntax::rle;
  CHECK(contains(refusal("b.dcm", slice(o)), "65535 x 65535"));
  o.syntax = Syntax::little;
  o.rows = 0;
  CHECK(contains(refusal("b.dcm", slice(o)), "0 rows"));
  o.rows = 2, o.columns = 3, o.bits = 12;
  CHECK(contains(refusal("b.dcm", slice(o)), "12 bits"));
  Dicom none;
  none.text(0x00080060, "CS", "SR");
  CHECK(contains(refusal("b.dcm", none.file()), "contains no picture"));
  none.body += "\xe0\x7f\x10";
  CHECK(contains(refusal("b.dcm", none.file()), "ends inside an element"));
  CHECK(contains(refusal("b.dcm", "some text that is long enough to look at"), "not a DICOM file"));
  // Sequences without an end, and one inside the other.
  Dicom deep;
  for (int i = 0; i < 1000; ++i)
    deep.body += i % 2 ? std::string("\xfe\xff\x00\xe0\xff\xff\xff\xff", 8) : std::string("\x08\x00\x40\x11SQ\0\0\xff\xff\xff\xff", 12);
  CHECK(contains(refusal("b.dcm", deep.file()), "more than 16 deep"));
  CHECK(contains(error_of([] { read_file(empty_folder("empty")); }), "folder of unknown kind"));
  o = {};
  o.syntax = Syntax::deflated, o.pixels = stored({1, 2, 3, 4, 5, 6});
  const std::string packed = slice(o);
  CHECK(contains(refusal("b.dcm", packed.substr(0, packed.size() - 20)), "deflated data is damaged or truncated"));
}

TEST_CASE("dicom: cut and damaged files give errors, never crashes") {
  SliceOptions o;
  o.pixels = stored({1, 2, 3, 4, 5, 6});
  for (const Syntax s : {Syntax::implicit, Syntax::big}) {
    o.syntax = s;
    o.pixels = stored({1, 2, 3, 4, 5, 6}, s);
    CHECK(cut_and_damage("cut.dcm", slice(o)) == 63);
  }
  o.syntax = Syntax::rle;
  o.pixels = stored({1, 2, 3, 4, 5, 6});
  Context context;
  const std::string good = slice(o);
  for (size_t k = 128; k < good.size(); k += k < 180 || k > good.size() - 90 ? 3 : 7)
    for (const int flip : {k % 2 ? 1 : 0xff}) {
      std::string bytes = good;
      bytes[k] = char(bytes[k] ^ flip);
      try {
        read_data(temp_file("flip.dcm", bytes), {}, context);
      } catch (const Error& e) {
        CHECK(e.kind() == ErrorKind::data);
      }
    }
}
