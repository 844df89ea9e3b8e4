// SPDX-License-Identifier: Apache-2.0
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("raw: a brick is read as told") {
  ReadOptions o;
  o.raw_dims = {2, 1, 2};
  o.raw_type = "u16";
  o.raw_header = 3;
  o.raw_big_endian = true;
  o.raw_spacing = {1, 2, 3};
  const auto d = read_text("b.raw", std::string("abc\0\1\1\0\2\1\0\7", 11), o);
  const auto* g = d->as<UniformGrid>();
  REQUIRE(g);
  CHECK(g->spacing == Vec3(1, 2, 3));
  const Array& a = d->fields()[0].array;
  CHECK(a.get(0) == 1);
  CHECK(a.get(1) == 256);
  CHECK(a.get(2) == 513);
  CHECK(a.get(3) == 7);
  o.raw_dims = {1, 1, 1};
  o.raw_components = 4;
  CHECK(read_text("b.raw", std::string("abc\0\1\1\0\2\1\0\7", 11), o)->fields()[0].components() == 4);
}

TEST_CASE("raw: a wrong size says what is needed and what there is") {
  ReadOptions o;
  o.raw_dims = {10, 10, 10};
  o.raw_type = "f32";
  const std::string little = refusal("b.raw", "0123456789ab", o);
  CHECK(contains(little, "needs 4000 bytes, but there are 12"));
  CHECK(contains(refusal("b.raw", std::string(4100, 'x'), o), "with a header of 100 bytes it would fit"));
  o.raw_header = 4096;
  CHECK(contains(refusal("b.raw", std::string(4000, 'x'), o), "needs 4000 bytes, but there are 0"));
  o.raw_dims = {size_t(1) << 40, size_t(1) << 40, 1};
  CHECK(contains(refusal("b.raw", "x", o), "too large"));
  o.raw_dims = {2, 2, 2};
  o.raw_type = "float80";
  CHECK(contains(refusal("b.raw", "x", o), "unknown element type 'float80'"));
  o.raw_type = "";
  CHECK(contains(refusal("b.raw", "x", o), "--type"));
  CHECK(contains(refusal("b.raw", "x"), "--dims"));
  o.raw_type = "u8";
  o.raw_components = 0;
  CHECK(contains(refusal("b.raw", "x", o), "components"));
}

TEST_CASE("raw: a size in the name and the length tell what the numbers are, with a warning") {
  const std::string path = test::temp_folder() + "ball_6x5x4.raw";
  Context context;
  std::string said;
  context.on_log = [&](LogLevel, std::string_view t) { said = t; };
  for (const bool big : {false, true}) {
    std::string bytes;
    for (int i = 0; i < 120; ++i) {
      const int v = 300 + i;
      bytes += char(big ? v >> 8 : v & 255);
      bytes += char(big ? v & 255 : v >> 8);
    }
    write_file(path, bytes);
    const DatasetPtr d = std::get<DatasetPtr>(read_data(path, {}, context));
    CHECK(d->as<UniformGrid>()->dims == std::array<size_t, 3>{6, 5, 4});
    CHECK(d->fields()[0].array.type() == ElementType::i16);
    CHECK(d->fields()[0].array.get(119) == 419);
    CHECK(said.find(big ? "6x5x4 i16, big-endian" : "6x5x4 i16, little-endian") != std::string::npos);
  }
  write_file(path, std::string(121, 'x'));
  CHECK(test::error_of([&] { read_data(path, {}, context); }).find("--dims") != std::string::npos);
}
