// SPDX-License-Identifier: Apache-2.0
#include "io/text/text_scan.h"

#include <fmt/core.h>

#include <cstdlib>

#include "io/io_files.h"

using namespace sg;

namespace {

template <class T>
T scanned(const std::string& s, bool whole = true) {
  const char *p = s.data(), *end = s.data() + s.size();
  T v{};
  const bool ok = scan_number(p, end, v);
  CAPTURE(s);
  CHECK(ok);
  if (whole) CHECK(p == end);
  return v;
}

}  // namespace

TEST_CASE("text_scan: numbers round as strtod and strtof do") {
  uint64_t state = 7;
  auto next = [&] { return state = state * 6364136223846793005u + 1442695040888963407u, state >> 20; };
  int wrong = 0;
  for (int i = 0; i < 200000; ++i) {
    std::string s;
    if (next() % 2) s += '-';
    const int digits = int(next() % 20);
    for (int d = 0; d < digits; ++d) s += char('0' + next() % 10);
    s += '.';
    for (int d = 0; d < int(next() % 12) + (digits == 0); ++d) s += char('0' + next() % 10);
    if (s.back() == '.') s += '5';
    if (next() % 3 == 0) s += fmt::format("e{}", int(next() % 700) - 350);
    const char *p = s.data(), *end = p + s.size(), *q = p;
    double d = 0;
    float f = 0;
    wrong += !scan_number(p, end, d) || p != end || d != std::strtod(s.c_str(), nullptr);
    wrong += !scan_number(q, end, f) || q != end || f != std::strtof(s.c_str(), nullptr);
  }
  CHECK(wrong == 0);
  // Halfway between two floats in decimal: rounding twice would go wrong.
  for (const char* s : {"16777217", "16777219", "1.00000005960464477539062500001", "1.000000059604644775390625", "0.1", "3.4028235e38",
                        "1e-45", "7e-46", "1.17549435e-38"})
    CHECK(scanned<float>(s) == std::strtof(s, nullptr));
}

TEST_CASE("text_scan: unusual numbers") {
  CHECK(scanned<double>("+.5") == 0.5);
  CHECK(scanned<double>("5.") == 5);
  CHECK(scanned<double>("-0") == 0);
  CHECK(std::signbit(scanned<double>("-0")));
  CHECK(scanned<double>("1e400") == HUGE_VAL);
  CHECK(scanned<double>("-1e400") == -HUGE_VAL);
  CHECK(scanned<double>("1e-400") == 0);
  CHECK(scanned<float>("1e39") == HUGE_VALF);
  CHECK(scanned<double>("0.00000000000000000000000000000000001e35") == 1);
  CHECK(std::isnan(scanned<double>("nan")));
  CHECK(std::isnan(scanned<float>("-NaN")));
  CHECK(scanned<double>("-inf") == -HUGE_VAL);
  CHECK(scanned<double>("2e", false) == 2);
  for (const std::string s : {"", "-", ".", "+-1", "e5", "nano", "x"}) {
    const char* p = s.data();
    double v = 0;
    CAPTURE(s);
    CHECK_FALSE(scan_number(p, s.data() + s.size(), v));
    CHECK(p == s.data());
  }
  CHECK(scanned<int64_t>("-123456789012345678") == -123456789012345678);
  const std::string long_one = "1234567890123456789";
  const char* p = long_one.data();
  int64_t i = 0;
  CHECK_FALSE(scan_number(p, p + long_one.size(), i));
}

TEST_CASE("text_scan: chunks end at lines and cover the text") {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += std::string(size_t(i % 17), 'a') + (i % 5 == 0 ? "\\\r\n" : "\n");
  text += "no end";
  for (const bool continued : {false, true})
    for (const size_t grain : {1, 7, 64, 100000}) {
      const auto b = text_chunks(text, grain, false, continued);
      CHECK(b.front() == 0);
      CHECK(b.back() == text.size());
      for (size_t i = 1; i + 1 < b.size(); ++i) {
        CHECK(b[i] > b[i - 1]);
        CHECK(text[b[i] - 1] == '\n');
        if (continued) CHECK(text[b[i] - 3] != '\\');
      }
    }
  CHECK(text_chunks("", 10).size() == 1);
  CHECK(line_number("a\nb\nc", 2) == 2);
}

TEST_CASE("text_scan: numbers of any layout, many threads") {
  std::string text;
  const size_t n = 100000;
  for (size_t i = 0; i < n; ++i) text += fmt::format("{}{}", double(i) * 0.25 - 100, i % 7 == 0 ? "\n" : i % 3 == 0 ? " , " : "\t ");
  const Array one = test::with_threads(1, [&] { return parse_numbers(text, ElementType::f64, n / 2, 2, "here"); });
  const Array four = test::with_threads(4, [&] { return parse_numbers(text, ElementType::f64, n / 2, 2, "here"); });
  CHECK(test::same_array(one, four));
  CHECK(one.get(49999, 1) == 99999 * 0.25 - 100);
  CHECK(parse_numbers("3.0 1e2 -7", ElementType::i16, 3, 1, "here").get(1) == 100);
  CHECK(parse_numbers("18446744073709551615", ElementType::u64, 1, 1, "here").view<uint64_t>()[0] == UINT64_MAX);
  CHECK(test::contains(test::error_of([] { parse_numbers("1 2", ElementType::f32, 2, 2, "here"); }), "cannot hold"));
  CHECK(
      test::contains(test::error_of([] { parse_numbers("1      2", ElementType::f32, 3, 1, "here"); }), "has 2 numbers, but 3 are needed"));
  CHECK(test::contains(test::error_of([] { parse_numbers("1 2x 3", ElementType::f32, 3, 1, "here", 4); }), "line 5: '2x'"));
  CHECK(test::contains(test::error_of([] { parse_numbers("1.5", ElementType::i32, 1, 1, "here"); }), "not a valid i32"));
}
