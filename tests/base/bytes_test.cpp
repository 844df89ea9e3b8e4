// SPDX-License-Identifier: Apache-2.0
#include "base/bytes.h"

#include "base/random.h"
#include "base/text/text.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("bytes: loads either byte order from any address") {
  const unsigned char b[] = {0xff, 0x12, 0x34, 0x56, 0x78, 0, 0, 0xf0, 0x3f};
  CHECK(load<uint32_t>(b + 1) == 0x78563412u);
  CHECK(load<uint32_t>(b + 1, true) == 0x12345678u);
  CHECK(load<uint16_t>(b + 1, true) == 0x1234u);
  CHECK(load<int8_t>(b, true) == -1);
  const unsigned char one[] = {0x3f, 0xf0, 0, 0, 0, 0, 0, 0};
  CHECK(load<double>(one, true) == 1.0);
}

TEST_CASE("bytes: swapping agrees with loading, twice is nothing, sizes 1 2 4 8, also above a chunk") {
  for (const size_t size : {1, 2, 4, 8})
    for (const size_t n : {0, 1, 7, 300'000}) {
      std::vector<unsigned char> v(n * size), out(n * size);
      for (size_t i = 0; i < v.size(); ++i) v[i] = static_cast<unsigned char>(random_bits(size, i));
      swap_bytes_copy(out.data(), v.data(), n, size);
      bool right = true;
      for (size_t i = 0; i < n; ++i)
        for (size_t k = 0; k < size; ++k) right = right && out[i * size + k] == v[i * size + size - 1 - k];
      CHECK(right);
      swap_bytes(out.data(), n, size);
      CHECK(out == v);
    }
  unsigned char x[3] = {};
  CHECK_THROWS_AS(swap_bytes(x, 1, 3), Error);
}

TEST_CASE("bytes: products and sums that overflow are told") {
  uint64_t r = 0;
  CHECK(multiply(1ull << 32, (1ull << 32) - 1, r));
  CHECK(r == 0xffffffff00000000ull);
  CHECK_FALSE(multiply(1ull << 32, 1ull << 32, r));
  CHECK(add(UINT64_MAX, 0, r));
  CHECK_FALSE(add(UINT64_MAX, 1, r));
}

TEST_CASE("text: numbers beyond the range of double become infinite or zero, of any form") {
  const std::string zeros(400, '0');
  CHECK(*parse_double("1" + zeros) == HUGE_VAL);
  CHECK(*parse_double("-1" + zeros) == -HUGE_VAL);
  CHECK(*parse_double("0." + zeros + "1") == 0);
  CHECK(*parse_double("0." + zeros + "1e800") == HUGE_VAL);
  CHECK(*parse_double("1" + zeros + "e-800") == 0);
  CHECK(*parse_double("1e-400") == 0);
  CHECK(*parse_double("-1e400") == -HUGE_VAL);
  CHECK(*parse_double("1e99999999999999999999") == HUGE_VAL);
  CHECK(*parse_double("0e99999999999999999999") == 0);
  CHECK(*parse_double("5e-324") > 0);
  for (const char* bad : {"+-5", "++5", "+", "1e", "0x10", "1,5", "1 2", "--1"}) CHECK_MESSAGE(!parse_double(bad), bad);
  CHECK_FALSE(parse_int("+-5"));
  CHECK(*parse_int(" +5 ") == 5);
  CHECK_FALSE(parse_int("9223372036854775808"));
}

TEST_CASE("text: exact numbers read back to the same bits") {
  for (uint64_t i = 0; i < 2000; ++i) {
    const uint64_t bits = random_bits(3, i);
    double v, back;
    std::memcpy(&v, &bits, 8);
    if (std::isnan(v)) continue;
    back = *parse_double(exact_number(v));
    CHECK(std::memcmp(&v, &back, 8) == 0);
  }
  CHECK(exact_number(0.1) == "0.1");
  CHECK(short_number(1.0 / 3, 3) == "0.333");
  CHECK(short_number(1500, 6) == "1500");
  CHECK(human_bytes(1023) == "1023 B");
  CHECK(human_bytes(64ull << 20) == "64.0 MiB");
}

TEST_CASE("text: numbers in a stated format") {
  CHECK(formatted_number(12.345, ".2f") == "12.35");
  CHECK(formatted_number(12.345, "%.0f") == "12");
  CHECK(formatted_number(12.345, ".3g") == "12.3");
  CHECK(formatted_number(0.00012345, ".1e") == "1.2e-04");
  CHECK(formatted_number(0.5, "g") == "0.5");
  CHECK(formatted_number(-2, "f") == "-2.000000");
  for (const char* wrong : {"", "%", ".", ".f", "..2f", ".2", ".2d", "2f", ".99f", ".-1f", "%s", "%n", ".2ff", "%%.2f"})
    CHECK(test::error_of([&] { formatted_number(1, wrong); }).find("is not a format of numbers") != std::string::npos);
}

TEST_CASE("text: bytes, booleans, words and JSON") {
  CHECK(*parse_bytes("1.5K") == 1536);
  CHECK(*parse_bytes("7") == 7);
  for (const char* bad : {"", "G", "-1", "nan", "1e30", "2X"}) CHECK_MESSAGE(!parse_bytes(bad), bad);
  CHECK(*parse_bool("Yes"));
  CHECK_FALSE(*parse_bool("off"));
  CHECK_FALSE(parse_bool("maybe"));
  CHECK(split("a, b,,c", ',') == std::vector<std::string_view>{"a", "b", "", "c"});
  CHECK(split("  ", ',').empty());
  CHECK(words("  a\tb\n c ") == std::vector<std::string_view>{"a", "b", "c"});
  CHECK(quoted_words("'' x") == std::vector<std::string>{"", "x"});
  CHECK(test::error_of([] { quoted_words("a 'b"); }).find("missing closing quote") != std::string::npos);
  CHECK(json_string("a\"\\\n\x01") == "\"a\\\"\\\\\\n\\u0001\"");
}
