// SPDX-License-Identifier: Apache-2.0
#include "io/options.h"

#include "support/property.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::error_of;

namespace {

ReadParams read_of(const std::vector<std::string>& words) {
  ReadParams p;
  Schema schema = schema_of(p);
  set_params(schema, words, "read");
  check(p.options);
  return p;
}

bool same(const ReadOptions& a, const ReadOptions& b) {
  return a.fields == b.fields && a.time == b.time && a.step == b.step && a.region == b.region && a.piece == b.piece &&
         a.pieces == b.pieces && a.ghost_levels == b.ghost_levels && a.raw_dims == b.raw_dims && a.raw_type == b.raw_type &&
         a.raw_big_endian == b.raw_big_endian && a.raw_header == b.raw_header && a.raw_components == b.raw_components &&
         a.raw_spacing == b.raw_spacing && a.csv_header == b.csv_header && a.times == b.times && a.format == b.format;
}

}  // namespace

TEST_CASE("property: options of a reader survive the way through words") {
  for (const uint64_t seed : test::property_seeds(50)) {
    CAPTURE(seed);
    test::Random random(seed);
    const auto maybe = [&] { return random.chance(0.5); };
    ReadOptions o;
    if (maybe()) o.fields = {"T", "wind speed"};
    if (maybe()) o.time = random.in(-5, 5);
    if (maybe()) o.step = random.whole(0, 100);
    if (maybe()) o.times = "0:0.5";
    if (maybe()) o.format = maybe() ? "nii.gz" : "delimited text";
    if (maybe()) o.csv_header = maybe() ? HeaderLine::yes : HeaderLine::no;
    for (size_t a = 0; a < 3; ++a) {
      if (maybe()) o.region.lo[a] = size_t(random.whole(0, 9)), o.region.hi[a] = o.region.lo[a] + size_t(random.whole(0, 9));
      if (maybe()) o.region.stride[a] = size_t(random.whole(1, 4));
    }
    if (maybe()) o.pieces = int(random.whole(2, 9)), o.piece = o.pieces - 1, o.ghost_levels = int(random.whole(0, 2));
    if (maybe()) {
      o.raw_dims = {size_t(random.whole(1, 99)), 5, 7}, o.raw_type = "u16", o.raw_big_endian = maybe(), o.raw_header = 12;
      o.raw_components = int(random.whole(1, 4)), o.raw_spacing = {0.5, 1, random.in(0.1, 2)};
    }
    const ReadParams back = read_of(read_words("a file.raw", o));
    CHECK(back.path == "a file.raw");
    // A clamped end is as good as the largest number.
    ReadOptions clamped = o;
    for (size_t a = 0; a < 3; ++a)
      if (!(o.region.lo == LatticeRegion().lo && o.region.hi == LatticeRegion().hi))
        clamped.region.hi[a] = std::min<size_t>(o.region.hi[a], INT64_MAX);
    CHECK(same(back.options, clamped));
  }
}

TEST_CASE("read options: what is not stated stays out of the words") {
  CHECK(read_words("a.vti", {}) == std::vector<std::string>{"path=a.vti"});
  CHECK(read_of({"path=a.vti", "stride=2"}).options.region.stride == std::array<size_t, 3>{2, 2, 2});
  CHECK(read_of({"region=1,2,3,4,5,6"}).options.region.hi == std::array<size_t, 3>{2, 4, 6});
}

TEST_CASE("read options: what cannot be says what would be right") {
  CHECK(contains(error_of([] { read_of({"dims=3,4"}); }), "list of 3"));
  CHECK(contains(error_of([] { read_of({"dims=3,4,5"}); }), "u8 i8"));
  CHECK(contains(error_of([] { read_of({"dims=3,4,0"}); }), "at least 1"));
  CHECK(contains(error_of([] { read_of({"type=f77"}); }), "not a number type"));
  CHECK(contains(error_of([] { read_of({"region=1,2"}); }), "list of 6"));
  CHECK(contains(error_of([] { read_of({"region=5,1,0,1,0,1"}); }), "begins at 5 and ends at 1"));
  CHECK(contains(error_of([] { read_of({"stride=1,2"}); }), "one or three numbers"));
  CHECK(contains(error_of([] { read_of({"piece=2", "pieces=2"}); }), "no piece 2 of 2"));
  CHECK(contains(error_of([] { read_of({"csv_header=maybe"}); }), "auto"));
}

TEST_CASE("write options: a format takes its own options and no others") {
  const auto of = [](const char* file, const std::vector<std::string>& words) { return write_options(format_to_write(file), words); };
  CHECK(of("a.nrrd", {"compression=gzip"}).compression == Compression::gzip);
  CHECK(contains(error_of([&] { of("a.nrrd", {"compression=lz4"}); }), "none"));
  CHECK(of("a.vtu", {"encoding=base64", "compression=lzma"}).encoding == VtkEncoding::base64);
  CHECK(of("a.zarr", {"chunk=32"}).chunk == 32);
  CHECK(contains(error_of([&] { of("a.zarr", {"chunk=4"}); }), "from 8 to 512"));
  CHECK_FALSE(of("a.stl", {"binary=false"}).binary);
  CHECK(contains(error_of([&] { of("a.stl", {"compression=zlib"}); }), "unknown parameter 'compression'"));
  CHECK(contains(error_of([&] { of("a.obj", {"binary=false"}); }), "no parameters"));
  CHECK(of("a.obj", {}).binary);
}
