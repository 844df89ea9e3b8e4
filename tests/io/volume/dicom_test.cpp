// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "data/lattice.h"
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

namespace {

enum class Syntax { implicit, little, big, rle };

// Builds DICOM files of a few elements.
struct Dicom {
  Syntax syntax = Syntax::little;
  std::string body;

  std::string number(uint64_t v, int bytes, bool big) const {
    std::string s;
    for (int i = 0; i < bytes; ++i) s += char(v >> (8 * (big ? bytes - 1 - i : i)) & 255);
    return s;
  }
  bool big() const { return syntax == Syntax::big; }
  std::string element(uint32_t tag, const std::string& vr, std::string value, bool implicit_vr) const {
    if (value.size() % 2) value += vr == "UI" || vr == "OB" ? '\0' : ' ';
    std::string s = number(tag >> 16, 2, big()) + number(tag & 0xffff, 2, big());
    if (implicit_vr) return s + number(value.size(), 4, false) + value;
    s += vr;
    if (vr == "OB" || vr == "OW" || vr == "SQ") return s + std::string(2, '\0') + number(value.size(), 4, big()) + value;
    return s + number(value.size(), 2, big()) + value;
  }
  void text(uint32_t tag, const std::string& vr, const std::string& v) { body += element(tag, vr, v, syntax == Syntax::implicit); }
  void whole(uint32_t tag, int v) { body += element(tag, "US", number(uint64_t(v), 2, big()), syntax == Syntax::implicit); }

  std::string shorts(const std::vector<int>& v) const {
    std::string s;
    for (const int x : v) s += number(uint64_t(x) & 0xffff, 2, big());
    return s;
  }
  std::string file() const {
    Dicom meta;
    const char* uid = syntax == Syntax::implicit ? "1.2.840.10008.1.2"
                      : syntax == Syntax::little ? "1.2.840.10008.1.2.1"
                      : syntax == Syntax::big    ? "1.2.840.10008.1.2.2"
                                                 : "1.2.840.10008.1.2.5";
    const std::string two = meta.element(0x00020010, "UI", uid, false);
    return std::string(128, '\0') + "DICM" + meta.element(0x00020000, "UL", meta.number(two.size(), 4, false), false) + two + body;
  }
};

struct SliceOptions {
  Syntax syntax = Syntax::little;
  std::string series = "1.2.3", position = "0\\0\\0", orientation = "1\\0\\0\\0\\1\\0", slope, intercept, photometric = "MONOCHROME2";
  int number = 1, columns = 3, rows = 2, stored = 16, frames = 1, samples = 1, planar = 0, bits = 16;
  bool is_signed = true;
  std::string pixels;  // as stored
};

std::string slice(const SliceOptions& o) {
  Dicom d;
  d.syntax = o.syntax;
  d.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2");
  d.text(0x00080060, "CS", "CT");
  d.text(0x0008103e, "LO", "test " + o.series);
  d.text(0x00100010, "PN", "Doe^John");
  d.text(0x0020000e, "UI", o.series);
  d.text(0x00200013, "IS", std::to_string(o.number));
  if (!o.position.empty()) d.text(0x00200032, "DS", o.position);
  if (!o.orientation.empty()) d.text(0x00200037, "DS", o.orientation);
  d.whole(0x00280002, o.samples);
  d.text(0x00280004, "CS", o.photometric);
  if (o.samples > 1) d.whole(0x00280006, o.planar);
  if (o.frames > 1) d.text(0x00280008, "IS", std::to_string(o.frames));
  d.whole(0x00280010, o.rows);
  d.whole(0x00280011, o.columns);
  d.text(0x00280030, "DS", "2\\0.5");
  d.whole(0x00280100, o.bits);
  d.whole(0x00280101, o.stored);
  d.whole(0x00280102, o.stored - 1);
  d.whole(0x00280103, o.is_signed);
  if (!o.intercept.empty()) d.text(0x00281052, "DS", o.intercept);
  if (!o.slope.empty()) d.text(0x00281053, "DS", o.slope);
  if (o.syntax == Syntax::rle) {
    // An empty offset table, one fragment with two byte planes as literal runs.
    std::string planes[2];
    for (size_t i = 0; i < o.pixels.size(); ++i) planes[i % 2 ? 0 : 1] += o.pixels[i];
    std::string data = d.number(2, 4, false) + d.number(64, 4, false);
    for (std::string& p : planes) {
      p = char(p.size() - 1) + p;
      if (p.size() % 2) p += char(-128);
    }
    data += d.number(64 + planes[0].size(), 4, false) + std::string(64 - 12, '\0') + planes[0] + planes[1];
    d.body += d.number(0x7fe0, 2, false) + d.number(0x10, 2, false) + "OB" + std::string(2, '\0') + d.number(0xffffffff, 4, false);
    auto item = [&](uint32_t tag, const std::string& v) {
      d.body += d.number(tag >> 16, 2, false) + d.number(tag & 0xffff, 2, false) + d.number(v.size(), 4, false) + v;
    };
    item(0xfffee000, "");
    item(0xfffee000, data);
    item(0xfffee0dd, "");
  } else {
    d.text(0x7fe00010, o.bits == 8 ? "OB" : "OW", o.pixels);
  }
  return d.file();
}

std::string stored(const std::vector<int>& v, Syntax s = Syntax::little) {
  Dicom d;
  d.syntax = s;
  return d.shorts(v);
}

double dicom_value(const DatasetPtr& d, size_t i, int c = 0) { return d->fields().require("DICOMImage").array.get(i, c); }
std::string note(const DatasetPtr& d, std::string_view key) {
  for (const auto& [k, v] : d->notes())
    if (k == key) return v;
  return "";
}

}  // namespace

TEST_CASE("dicom: implicit, explicit, big endian and run-length files hold the same numbers") {
  const std::vector<int> v{-5, 0, 7, 300, -300, 32767};
  for (const Syntax s : {Syntax::implicit, Syntax::little, Syntax::big, Syntax::rle}) {
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
