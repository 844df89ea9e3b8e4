// SPDX-License-Identifier: Apache-2.0
// Numbers and lines in large texts, fast: in-place scanning of numbers, and chunks of a text that end at line ends, so that
// they can be read in parallel. Nothing here allocates per number or looks at the locale.
#pragma once
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "data/array.h"

namespace sg {

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }
inline bool is_space(char c) { return c == '\n' || is_blank(c); }
inline bool is_digit(char c) { return unsigned(c - '0') < 10u; }

inline const char* skip_blanks(const char* p, const char* end) {
  while (p < end && is_blank(*p)) ++p;
  return p;
}
inline const char* skip_word(const char* p, const char* end) {
  while (p < end && !is_space(*p)) ++p;
  return p;
}
inline const char* line_end(const char* p, const char* end) {
  const void* q = p < end ? std::memchr(p, '\n', size_t(end - p)) : nullptr;
  return q ? static_cast<const char*>(q) : end;
}

namespace detail {
/// Parts of a decimal number: mantissa * 10^exponent; exact = all digits fit.
struct Decimal {
  uint64_t mantissa = 0;
  int exponent = 0;
  bool negative = false, exact = true;
};

inline constexpr double powers_of_ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                           1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// Scans [sign] digits [. digits] [e [sign] digits]; null when there is no digit.
inline const char* scan_decimal(const char* p, const char* end, Decimal& d) {
  if (p < end && (*p == '-' || *p == '+')) d.negative = *p++ == '-';
  const char* first = p;
  uint64_t m = 0;
  while (p < end && is_digit(*p)) m = m * 10 + uint64_t(*p++ - '0');
  ptrdiff_t digits = p - first;
  if (p < end && *p == '.') {
    const char* point = ++p;
    while (p < end && is_digit(*p)) m = m * 10 + uint64_t(*p++ - '0');
    d.exponent = -int(std::min<ptrdiff_t>(p - point, 100000));
    digits += p - point;
  }
  if (digits == 0) return nullptr;
  d.exact = digits <= 19;
  if (p < end && (*p == 'e' || *p == 'E')) {
    const char* q = p + 1;
    bool minus = false;
    if (q < end && (*q == '-' || *q == '+')) minus = *q++ == '-';
    if (q < end && is_digit(*q)) {
      int e = 0;
      while (q < end && is_digit(*q)) e = e < 100000 ? e * 10 + (*q - '0') : e, ++q;
      d.exponent += minus ? -e : e;
      p = q;
    }
  }
  d.mantissa = m;
  return p;
}

/// The correctly rounded double by one multiplication or division, where both factors are exact; false otherwise.
inline bool fast_double(const Decimal& d, double& v) {
  if (!d.exact || d.mantissa > (uint64_t(1) << 53) || d.exponent < -22 || d.exponent > 22) return false;
  v = double(d.mantissa);
  v = d.exponent < 0 ? v / powers_of_ten[-d.exponent] : v * powers_of_ten[d.exponent];
  if (d.negative) v = -v;
  return true;
}

const char* slow_double(const char* p, const char* end, double& v);
const char* slow_float(const char* p, const char* end, float& v);
}  // namespace detail

/// Reads the number at p (no blanks before it) and moves p behind it; false (p unmoved) when there is none. Correctly
/// rounded; accepts nan, inf, a leading '+' and numbers like .5 and 5. ; overflow gives infinity.
inline bool scan_number(const char*& p, const char* end, double& v) {
  detail::Decimal d;
  const char* q = detail::scan_decimal(p, end, d);
  if (!q || !detail::fast_double(d, v)) q = detail::slow_double(p, end, v);
  if (q) p = q;
  return q != nullptr;
}
inline bool scan_number(const char*& p, const char* end, float& v) {
  detail::Decimal d;
  double wide = 0;
  const char* q = detail::scan_decimal(p, end, d);
  bool fast = q && detail::fast_double(d, wide);
  if (fast) {
    // Rounding twice goes wrong only when the double lies exactly between two floats (or near the subnormal ones).
    uint64_t bits;
    std::memcpy(&bits, &wide, 8);
    const double size = wide < 0 ? -wide : wide;
    fast = (bits & 0x1fffffffu) != 0x10000000u && (size == 0 || (size > 1e-37 && size < 1e38));
    v = float(wide);
  }
  if (!fast) q = detail::slow_float(p, end, v);
  if (q) p = q;
  return q != nullptr;
}
/// The same for a whole number with a sign; false when there is none or it does not fit.
inline bool scan_number(const char*& p, const char* end, int64_t& v) {
  const char* q = p;
  bool negative = false;
  if (q < end && (*q == '-' || *q == '+')) negative = *q++ == '-';
  const char* first = q;
  uint64_t m = 0;
  while (q < end && is_digit(*q)) m = m * 10 + uint64_t(*q++ - '0');
  if (q == first || q - first > 18) return false;
  v = negative ? -int64_t(m) : int64_t(m);
  p = q;
  return true;
}

/// Borders of chunks of about `grain` bytes: front 0, back text.size(), each the begin of a line (or, with `words`, of any
/// word). They depend only on the text and the grain. With `continued`, a line that ends in a backslash continues on the next.
std::vector<size_t> text_chunks(std::string_view text, size_t grain, bool words = false, bool continued = false);

/// 1-based number of the line that holds byte `at`.
size_t line_number(std::string_view text, size_t at);

/// The first `count` numbers of a text, blanks or commas between them, as packed tuples of `components`. Throws Error(data)
/// naming `where` when there are fewer, a word is not a number, or a number does not fit the type; `lines_before` the text are
/// counted in line numbers.
Array parse_numbers(std::string_view text, ElementType type, size_t count, int components, const std::string& where,
                    size_t lines_before = 0);

}  // namespace sg
