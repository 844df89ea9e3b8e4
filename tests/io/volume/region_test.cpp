// SPDX-License-Identifier: Apache-2.0
// A region of a volume file equals the same part cut from the whole, for every way of storing.
#include <fmt/core.h>

#include "data/lattice.h"
#include "data/lattice_crop.h"
#include "io/bytes/inflate.h"
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

namespace {

// 6 x 5 x 4 points of 0, 1, 2, ...
std::string numbers(bool big, size_t from = 0, size_t to = 120, int components = 1) {
  std::string s;
  for (size_t i = from * size_t(components); i < to * size_t(components); ++i) {
    const char lo = char(i & 255), hi = char(i >> 8);
    s += big ? hi : lo, s += big ? lo : hi;
  }
  return s;
}
std::string packed(const std::string& s) {
  const auto p = pack_gzip({reinterpret_cast<const std::byte*>(s.data()), s.size()});
  return {reinterpret_cast<const char*>(p.data()), p.size()};
}

void check_regions(const std::string& path, ReadOptions o = {}) {
  CAPTURE(path);
  const auto whole = read_file(path, o);
  struct Part {
    std::array<size_t, 3> lo, hi, stride;
  };
  for (const Part& p : {Part{{1, 2, 1}, {4, 4, 2}, {1, 1, 1}}, Part{{0, 0, 3}, {99, 99, 99}, {2, 3, 1}},
                        Part{{5, 4, 0}, {5, 4, 3}, {1, 1, 3}}, Part{{0, 0, 0}, {5, 4, 3}, {1, 1, 1}}}) {
    o.region.lo = p.lo, o.region.hi = p.hi, o.region.stride = p.stride;
    const auto part = read_file(path, o);
    const auto want = crop_lattice(*whole, p.lo, p.hi, p.stride);
    CHECK(lattice_dims(part->mesh()) == lattice_dims(want->mesh()));
    CHECK(part->bounds().lo == want->bounds().lo);
    CHECK(part->bounds().hi == want->bounds().hi);
    REQUIRE(part->fields().size() == 1);
    CHECK(part->fields()[0].role == whole->fields()[0].role);
    CHECK(same_array(part->fields()[0].array, want->fields()[0].array));
  }
  o.region = {};
  o.region.lo = {0, 5, 0};
  CHECK(contains(error_of([&] { read_file(path, o); }), "axis y"));
  o.region.lo = {0, 0, 0};
  o.region.stride = {1, 0, 1};
  CHECK(contains(error_of([&] { read_file(path, o); }), "stride is 0"));
}

}  // namespace

TEST_CASE("region: NRRD in every encoding") {
  const std::string head = "NRRD0004\ntype: short\ndimension: 3\nsizes: 6 5 4\nspacings: 1 2 3\n";
  for (const bool big : {false, true}) {
    const std::string order = big ? "endian: big\n" : "endian: little\n";
    check_regions(temp_file("r.nrrd", head + order + "encoding: raw\n\n" + numbers(big)));
    check_regions(temp_file("r.nrrd", head + order + "encoding: raw\nbyte skip: 5\n\nabcde" + numbers(big)));
    check_regions(temp_file("r.nrrd", head + order + "encoding: gzip\n\n" + packed(numbers(big))));
    check_regions(temp_file("r.nrrd", head + order + "encoding: gzip\nbyte skip: 7\n\n" + packed("1234567" + numbers(big))));
    temp_file("r1.raw", numbers(big, 0, 60));
    temp_file("r2.raw", numbers(big, 60, 120));
    check_regions(temp_file("r.nhdr", head + order + "encoding: raw\ndata file: LIST 3\nr1.raw\nr2.raw\n"));
  }
  std::string text;
  for (int i = 0; i < 120; ++i) text += std::to_string(i) + " ";
  check_regions(temp_file("r.nrrd", head + "encoding: ascii\n\n" + text));
  const std::string order = "encoding: raw\nendian: big\n";
  check_regions(temp_file("r.nrrd", "NRRD0004\ntype: short\ndimension: 4\nsizes: 3 6 5 4\nkinds: 3-vector domain domain domain\n" + order +
                                        "\n" + numbers(true, 0, 120, 3)));
  check_regions(temp_file("r.nrrd", "NRRD0004\ntype: short\ndimension: 4\nsizes: 6 5 4 3\nkinds: domain domain domain 3-vector\n" + order +
                                        "\n" + numbers(true, 0, 120, 3)));
}

TEST_CASE("region: MetaImage raw, packed, in slices, with channels and further axes") {
  const std::string head = "NDims = 3\nDimSize = 6 5 4\nElementSpacing = 1 2 3\nElementType = MET_SHORT\n";
  check_regions(temp_file("r.mha", head + "ElementDataFile = LOCAL\n" + numbers(false)));
  check_regions(temp_file("r.mha", head + "ElementByteOrderMSB = True\nElementDataFile = LOCAL\n" + numbers(true)));
  check_regions(temp_file("r.mha", head + "CompressedData = True\nElementDataFile = LOCAL\n" + packed(numbers(false))));
  check_regions(temp_file("r.mha", head + "ElementNumberOfChannels = 3\nElementDataFile = LOCAL\n" + numbers(false, 0, 120, 3)));
  for (size_t k = 0; k < 4; ++k) temp_file(fmt::format("s{}.raw", k), numbers(false, 30 * k, 30 * k + 30));
  check_regions(temp_file("r.mhd", head + "ElementDataFile = s%d.raw 0 3 1\n"));
  check_regions(
      temp_file("r.mha", "NDims = 4\nDimSize = 6 5 4 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" + numbers(false, 0, 240)));
}

TEST_CASE("region: raw bricks") {
  ReadOptions o;
  o.raw_dims = {6, 5, 4};
  o.raw_type = "u16";
  o.raw_spacing = {1, 2, 3};
  check_regions(temp_file("r.raw", numbers(false)), o);
  o.raw_big_endian = true;
  o.raw_header = 3;
  check_regions(temp_file("r.raw", "abc" + numbers(true)), o);
}

TEST_CASE("region: a cut gzip stream is refused where the wanted rows are missing") {
  const std::string head = "NRRD0004\ntype: short\ndimension: 3\nsizes: 6 5 4\nendian: little\nencoding: gzip\n\n",
                    p = packed(numbers(false));
  ReadOptions o;
  o.region.lo = {0, 0, 3};
  CHECK(contains(refusal("r.nrrd", head + p.substr(0, p.size() / 2), o), "damaged or truncated"));
  CHECK(contains(refusal("r.nrrd", head + packed(numbers(false, 0, 100)), o), "more are needed"));
}
