// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "data/lattice.h"
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

namespace {

// 4 x 3 x 2 bytes: 7 7 7 7 1 2 3 4 5 6 8 9, then the same backwards.
const std::string slice_a = "\x07\x07\x07\x07\x01\x02\x03\x04\x05\x06\x08\x09", slice_b(slice_a.rbegin(), slice_a.rend());
std::string packed_slices() {
  const std::string a = std::string("\x04\x07\x88") + slice_a.substr(4) + std::string(1, '\0');
  const std::string b = "\x88" + slice_b.substr(0, 8) + "\x04\x07" + std::string(1, '\0');
  return fmt::format("{} X", a.size()) + a + fmt::format("\n{} X", b.size()) + b;
}
std::string slc(const std::string& sizes, int packing, const std::string& body) {
  return "11111\n" + sizes + " 8\n1.0 2.0 0.5\n1 6 0 " + std::to_string(packing) + "\n2 1 X" + "abcdef" + body;
}

DatasetPtr part(const Data& data, size_t i) { return std::get<DatasetPtr>(std::get<CollectionPtr>(data)->parts.at(i).data); }
Data read_parts(const std::string& bytes, const ReadOptions& o = {}) {
  Context context;
  return read_data(temp_file("c.cube", bytes), o, context);
}
const std::string title = "a title\n density \n";
const std::string axes = "2 0.5 0 0\n3 0 0.25 0\n2 0.1 0 1\n";

}  // namespace

TEST_CASE("slc: raw and packed slices are the same bytes") {
  for (const int packing : {0, 1}) {
    const std::string bytes = slc("4 3 2", packing, packing ? packed_slices() : slice_a + slice_b);
    const auto d = read_text("v.slc", bytes);
    CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{4, 3, 2});
    CHECK(d->as<UniformGrid>()->spacing == Vec3(1, 2, 0.5));
    for (size_t i = 0; i < 24; ++i) CHECK(d->fields()[0].array.get(i) == double((slice_a + slice_b)[i]));
    ReadOptions o;
    o.region.lo = {1, 1, 1};
    o.region.stride = {2, 1, 1};
    const auto p = read_text("v.slc", bytes, o);
    CHECK(lattice_dims(p->mesh()) == std::array<size_t, 3>{2, 2, 1});
    CHECK(p->fields()[0].array.get(1) == double(slice_b[7]));
    CHECK(p->fields()[0].array.get(2) == double(slice_b[9]));
  }
}

TEST_CASE("slc: slices that lack up to a row at their end are read, and it is said") {
  // 12 bytes are wanted, 11 come; the other slice is whole.
  const std::string a = std::string("\x04\x07\x87") + slice_a.substr(4, 7) + std::string(1, '\0');
  const std::string b = "\x88" + slice_b.substr(0, 8) + "\x04\x07" + std::string(1, '\0');
  const std::string bytes = slc("4 3 2", 1, fmt::format("{} X", a.size()) + a + fmt::format("\n{} X", b.size()) + b);
  std::vector<std::string> said;
  Context context;
  context.on_log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) said.emplace_back(text);
  };
  const Data data = read_data(temp_file("short.slc", bytes), {}, context);
  const auto& d = std::get<DatasetPtr>(data);
  CHECK(d->fields()[0].array.get(10) == 8);
  CHECK(d->fields()[0].array.get(11) == 0);
  CHECK(d->fields()[0].array.get(12) == 9);
  REQUIRE(said.size() == 1);
  CHECK(contains(said[0], "slice 0 is 1 byte short; read as 0"));
}

TEST_CASE("slc: a file that ends up to a row early is read, one that ends earlier is not") {
  const std::string a = "\x8c" + slice_a + std::string(1, '\0'), b = "\x8c" + slice_b + std::string(1, '\0');
  const std::string whole = slc("4 3 2", 1, fmt::format("{} X", a.size()) + a + fmt::format("\n{} X", b.size()) + b);
  const auto last = [&](size_t lacks) {
    Context context;
    const Data data = read_data(temp_file("cut.slc", whole.substr(0, whole.size() - lacks)), {}, context);
    return std::get<DatasetPtr>(data)->fields()[0].array.get(23);
  };
  CHECK(last(0) == double(uint8_t(slice_b[11])));
  CHECK(last(1) == double(uint8_t(slice_b[11])));  // the mark of the end alone
  CHECK(last(2) == 0);
  CHECK_THROWS_AS(last(6), Error);
}

TEST_CASE("slc: bad headers and slices are refused") {
  CHECK(contains(refusal("b.slc", slc("4 3 9", 0, slice_a)), "too short: slice 1"));
  CHECK(contains(refusal("b.slc", slc("0 3 2", 0, slice_a)), "size of 0"));
  CHECK(contains(refusal("b.slc", slc("999999 999999 2", 1, "20 X" + std::string(40, 'x'))), "cannot decompress"));
  CHECK(contains(refusal("b.slc", slc("9999999999 3 2", 0, slice_a)), "a size is"));
  CHECK(contains(refusal("b.slc", slc("4 3 2", 7, slice_a)), "compression 7"));
  CHECK(contains(refusal("b.slc", slc("4 3 1", 1, "2 X\x04\x07")), "make 4 of 12 bytes"));
  CHECK(contains(refusal("b.slc", slc("4 3 1", 1, "2 X\x7f\x07")), "run lengths"));
  CHECK(contains(refusal("b.slc", slc("4 3 1", 1, "12 Y" + slice_a)), "'X'"));
  // All places to cut at but the one before the mark that ends the last slice.
  CHECK(cut_and_damage("cut.slc", slc("4 3 2", 1, packed_slices())) == 62);
}

TEST_CASE("cube: a number lies where its place in the file says") {
  std::string body;
  for (int i = 0; i < 12; ++i) body += fmt::format(" {}.5E+00{}", i, i % 6 == 5 ? "\n" : "");
  const Data data = read_parts(title + "2 1 2 3\n" + axes + "8 8.0 0 0 0.1\n1 1.0 0 1 0.2\n" + body);
  const auto grid = part(data, 0), atoms = part(data, 1);
  CHECK(lattice_dims(grid->mesh()) == std::array<size_t, 3>{2, 3, 2});
  const Field& f = grid->fields().require("density");
  const Lattice lattice(grid->mesh());
  for (size_t x = 0; x < 2; ++x)
    for (size_t y = 0; y < 3; ++y)
      for (size_t z = 0; z < 2; ++z) {
        CHECK(f.array.get(x + 2 * (y + 3 * z)) == double(z + 2 * (y + 3 * x)) + 0.5);
        const Vec3 want(1 + 0.5 * double(x) + 0.1 * double(z), 2 + 0.25 * double(y), 3 + double(z));
        CHECK(length(lattice.view().position(x, y, z) - want) < 1e-12);
      }
  CHECK(atoms->point_count() == 2);
  CHECK(atoms->fields().require("atomic number").array.get(0) == 8);
  CHECK(atoms->as<PointCloud>()->points.at(1) == Vec3(0, 1, 0.2));
  CHECK(grid->notes()[1] == std::pair<std::string, std::string>("length unit", "bohr"));
}

TEST_CASE("cube: orbitals are components, negative counts mean Angstrom, a region is cut") {
  std::string body;
  for (int i = 0; i < 24; ++i) body += fmt::format("{} ", i);
  const std::string text = title + "-1 0 0 0\n-2 0.5 0 0\n-3 0 0.25 0\n-2 0 0 1\n8 8 0 0 0\n2 5\n7\n" + body;
  auto grid = part(read_parts(text), 0);
  CHECK(grid->fields()[0].components() == 2);
  CHECK(grid->fields()[0].array.get(1 + 2 * (2 + 3 * 1), 1) == 23);
  CHECK(grid->notes()[1].second == "angstrom");
  CHECK(grid->notes()[2].second == "5 7");
  ReadOptions o;
  o.region.lo = {1, 1, 1};
  grid = part(read_parts(text, o), 0);
  CHECK(lattice_dims(grid->mesh()) == std::array<size_t, 3>{1, 2, 1});
  CHECK(grid->fields()[0].array.get(1, 0) == 22);
  grid = part(read_parts(title + "0 0 0 0 2\n2 1 0 0\n3 0 1 0\n2 0 0 1\n" + body), 0);
  CHECK(grid->fields()[0].components() == 2);
}

TEST_CASE("cube: what is wrong is said with its line") {
  auto refused = [](const std::string& bytes) { return error_of([&] { read_parts(bytes); }); };
  CHECK(contains(refused(title + "1 0 0\n"), "line 3: 4 numbers are needed"));
  CHECK(contains(refused(title + "1 0 0 x\n"), "line 3: 'x' is not a number"));
  CHECK(contains(refused(title + "1.5 0 0 0\n" + axes), "'1.5' is not a valid count"));
  CHECK(contains(refused(title + "0 0 0 0\n2 1 0 0\n0 0 1 0\n2 0 0 1\n1 2 3 4"), "line 5: there are no points"));
  CHECK(contains(refused(title + "0 0 0 0\n2 1 0 0\n3 2 0 0\n2 0 0 1\n1 2 3 4"), "coplanar"));
  CHECK(contains(refused(title + "99999999 0 0 0\n" + axes), "99999999 atoms"));
  CHECK(contains(refused(title + "0 0 0 0\n999999999 1 0 0\n999999999 0 1 0\n999999999 0 0 1\n1 2"), "too large"));
  CHECK(contains(refused(title + "0 0 0 0\n9999 1 0 0\n9999 0 1 0\n9999 0 0 1\n1 2"), "cannot hold"));
  CHECK(contains(refused(title + "-1 0 0 0\n" + axes + "8 8 0 0 0\n0\n"), "0 orbitals"));
  CHECK(contains(refused(title + "0 0 0 0\n"), "inside its header"));
  std::string body;
  for (int i = 0; i < 12; ++i) body += fmt::format("1.{}E+00 ", i + 10);
  CHECK(cut_and_damage("cut.cube", title + "1 1 2 3\n" + axes + "8 8.0 0 0 0.1\n" + body) >= 62);
}
