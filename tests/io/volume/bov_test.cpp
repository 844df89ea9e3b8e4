// SPDX-License-Identifier: Apache-2.0
// BOV: headers, bricklets, packed data, bricks without a header, and bad input.
#include <fmt/core.h>

#include "io/bytes/inflate.h"
#include "io/cases/case_files.h"

using namespace sg;
using namespace sg::test;

namespace {

std::string floats(size_t n, bool big = false, size_t from = 0) {
  std::string s;
  for (size_t i = 0; i < n; ++i) put_bytes(s, float(from + i) + 0.5f, big);
  return s;
}

const std::string bov_head = "# a brick\nTIME: 1.5\nDATA_FILE: v.dat\nDATA_SIZE: 4 3 2\nDATA_FORMAT: FLOAT\nVARIABLE: \"rho\"\n";

DatasetPtr read_bov_case(const std::string& name, const CaseFiles& files, const ReadOptions& o = {}) {
  return std::get<DatasetPtr>(read_any(write_case(name, files) + "a.bov", o));
}

}  // namespace

TEST_CASE("bov: sizes, order of bytes, place in space and time") {
  const auto d = read_bov_case(
      "bov1", {{"a.bov", bov_head + "DATA_ENDIAN: BIG\nCENTERING: nodal\nBRICK_ORIGIN: 1 2 3\nBRICK_SIZE: 6 4 1\nBYTE_OFFSET: 8\n"},
               {"v.dat", "8 bytes." + floats(24, true)}});
  const auto* g = d->as<UniformGrid>();
  REQUIRE(g);
  CHECK(g->dims == std::array<size_t, 3>{4, 3, 2});
  CHECK(g->spacing == Vec3{2, 2, 1});
  CHECK(g->origin == Vec3{1, 2, 3});
  CHECK(d->time() == 1.5);
  CHECK(d->fields().require("rho", Association::point).array.get(23) == 23.5);
}

TEST_CASE("bov: zonal values lie in the cells of a grid with one point more") {
  const auto d = read_bov_case("bov2", {{"a.bov", bov_head + "CENTERING: zonal\nBRICK_SIZE: 8 3 2\n"}, {"v.dat", floats(24)}});
  CHECK(d->as<UniformGrid>()->dims == std::array<size_t, 3>{5, 4, 3});
  CHECK(d->as<UniformGrid>()->spacing == Vec3{2, 1, 1});
  CHECK(d->fields().require("rho", Association::cell).array.count() == 24);
}

TEST_CASE("bov: bricklets in several files are put together, and packed files unpacked") {
  CaseFiles files{{"a.bov", "DATA_FILE: p%02d.gz\nDATA_SIZE: 4 2 2\nDATA_FORMAT: FLOAT\nDATA_BRICKLETS: 2 2 1\n"}};
  for (size_t i = 0; i < 4; ++i) {
    const std::string raw = floats(4, false, i * 100);
    const auto packed = pack_gzip({reinterpret_cast<const std::byte*>(raw.data()), raw.size()});
    files[fmt::format("p{:02}.gz", i)] = std::string(reinterpret_cast<const char*>(packed.data()), packed.size());
  }
  const auto d = read_bov_case("bov3", files);
  const Array& a = d->fields().require("values").array;
  CHECK(a.get(1) == 1.5);
  CHECK(a.get(2) == 100.5);   // second file, to the right
  CHECK(a.get(4) == 2.5);     // first file, next row
  CHECK(a.get(15) == 303.5);  // last file, last number
}

TEST_CASE("bov: fields that are not asked for are not read, nor values for a quick look") {
  ReadOptions o;
  o.header_only = true;
  const auto d = read_bov_case("bov4", {{"a.bov", bov_head + "DATA_COMPONENTS: 3\n"}}, o);  // without its data file
  CHECK(d->fields().require("rho").components() == 3);
  o.header_only = false;
  o.fields = {"other"};
  CHECK(read_bov_case("bov4", {{"a.bov", bov_head}}, o)->fields().empty());
}

TEST_CASE("bov: a brick without a header tells its size by its name and its type by its length") {
  const std::string root = write_case("bov5", {{"x_2_5x4x3.bov", floats(60, true)},
                                               {"y_5x4x3.bov", std::string(60, '\7')},
                                               {"z_5x4x3.bov", std::string(61, '\7')},
                                               {"w.bov", std::string(60, '\7')}});
  Context context;
  std::string said;
  context.on_log = [&](LogLevel, std::string_view text) { said += std::string(text); };
  const auto d = std::get<DatasetPtr>(read_data(root + "x_2_5x4x3.bov", {}, context));
  CHECK(d->as<UniformGrid>()->dims == std::array<size_t, 3>{5, 4, 3});
  CHECK(d->fields()[0].array.get(59) == 59.5);  // big-endian: the other order gives absurd numbers
  CHECK(contains(said, "has no header; read as 5x4x3 f32, big-endian"));
  CHECK(std::get<DatasetPtr>(read_any(root + "y_5x4x3.bov"))->fields()[0].array.type() == ElementType::u8);
  CHECK(contains(error_of([&] { read_any(root + "z_5x4x3.bov"); }), "give --dims"));
  CHECK(contains(error_of([&] { read_any(root + "w.bov"); }), "do not tell the size"));
  ReadOptions o;
  o.raw_dims = {3, 4, 5}, o.raw_type = "u8";
  CHECK(std::get<DatasetPtr>(read_any(root + "w.bov", o))->point_count() == 60);
}

TEST_CASE("bov: errors say what is wrong and where") {
  auto refused = [](const std::string& header, const std::string& data = floats(24)) {
    return error_of([&] { read_bov_case("bov_bad", {{"a.bov", header}, {"v.dat", data}}); });
  };
  CHECK(contains(refused(bov_head, floats(23)), "96 bytes are needed"));
  CHECK(contains(refused(bov_head + "DATA_SIZE: 4 3\n"), "line 7: expected three numbers"));
  CHECK(contains(refused(bov_head + "DATA_SIZE: 4 3 0\n"), "'0' is not a valid count from 1"));
  CHECK(contains(refused(bov_head + "DATA_SIZE: 9223372036854775807 9223372036854775807 4\n"), "too large"));
  CHECK(contains(refused(bov_head + "DATA_FORMAT: HALF\n"), "unknown DATA_FORMAT 'HALF'"));
  CHECK(contains(refused(bov_head + "DATA_FILE: v%d.dat\nDATA_BRICKLETS: 3 3 2\n"), "do not divide"));
  CHECK(contains(refused(bov_head + "DATA_FILE: none.dat\n"), "none.dat"));
  CHECK(contains(refused(bov_head + "no colon\n"), "not of the form KEY: VALUE"));
}

TEST_CASE("bov: damaged files give an error or a valid brick") {
  const CaseFiles files{{"a.bov", bov_head + "DATA_ENDIAN: LITTLE\nBRICK_SIZE: 1 1 1\nBYTE_OFFSET: 0\n"}, {"v.dat", floats(24)}};
  cut_and_damage_case("bov_damage", files, "a.bov", "a.bov");
  CHECK(cut_and_damage_case("bov_damage", files, "v.dat", "a.bov") == 63);
}
