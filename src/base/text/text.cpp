// SPDX-License-Identifier: Apache-2.0
#include "base/text/text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/text/utf8.h"

namespace sg {

namespace {
bool blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }
}  // namespace

std::string_view trim(std::string_view s) {
  while (!s.empty() && blank(s.front())) s.remove_prefix(1);
  while (!s.empty() && blank(s.back())) s.remove_suffix(1);
  return s;
}

std::string to_lower(std::string_view s) {
  std::string r(s);
  for (char& c : r) c = char(std::tolower(static_cast<unsigned char>(c)));
  return r;
}

bool equal_ignoring_case(std::string_view a, std::string_view b) { return a.size() == b.size() && to_lower(a) == to_lower(b); }

std::vector<std::string_view> split(std::string_view s, char separator) {
  std::vector<std::string_view> parts;
  if (trim(s).empty()) return parts;
  for (;;) {
    const size_t at = s.find(separator);
    parts.push_back(trim(s.substr(0, at)));
    if (at == std::string_view::npos) return parts;
    s.remove_prefix(at + 1);
  }
}

std::vector<std::string_view> words(std::string_view s) {
  std::vector<std::string_view> r;
  size_t i = 0;
  while (i < s.size()) {
    while (i < s.size() && blank(s[i])) ++i;
    size_t begin = i;
    while (i < s.size() && !blank(s[i])) ++i;
    if (i > begin) r.push_back(s.substr(begin, i - begin));
  }
  return r;
}

std::vector<std::string> quoted_words(std::string_view s) {
  std::vector<std::string> r;
  std::string word;
  bool open = false;
  for (size_t i = 0; i < s.size(); ++i) {
    const char c = s[i];
    if (c == '\'' || c == '"') {
      const size_t end = s.find(c, i + 1);
      if (end == std::string_view::npos) fail_usage("missing closing quote", std::string(s));
      word += s.substr(i + 1, end - i - 1);
      i = end;
      open = true;
    } else if (!blank(c)) {
      word += c;
      open = true;
    } else if (open) {
      r.push_back(std::move(word));
      word.clear();
      open = false;
    }
  }
  if (open) r.push_back(std::move(word));
  return r;
}

namespace {

// One leading plus, but not the one of "+-5".
std::string_view without_plus(std::string_view s) {
  if (s.size() > 1 && s[0] == '+' && s[1] != '-') s.remove_prefix(1);
  return s;
}

// Power of ten of the first nonzero digit of a well-formed number.
double decimal_exponent(std::string_view s) {
  const size_t e = s.find_first_of("eE");
  const std::string_view digits = s.substr(0, e);
  double power = 0;
  if (e != s.npos) {
    for (const char c : s.substr(e + 1))
      if (c >= '0' && c <= '9') power = std::min(1e9, power * 10 + (c - '0'));
    if (s[e + 1] == '-') power = -power;
  }
  const size_t point = std::min(digits.find('.'), digits.size()), first = digits.find_first_of("123456789");
  if (first == s.npos) return 0;
  return power + (first < point ? double(point - first) - 1 : double(point) - double(first));
}

}  // namespace

std::optional<double> parse_double(std::string_view s) {
  s = without_plus(trim(s));
  double v = 0;
  const auto [end, error] = std::from_chars(s.data(), s.data() + s.size(), v);
  if (s.empty() || end != s.data() + s.size()) return {};
  if (error == std::errc::result_out_of_range) {  // from_chars leaves v alone: overflow or underflow?
    const double sign = s[0] == '-' ? -1.0 : 1.0;
    return decimal_exponent(s) > 0 ? sign * HUGE_VAL : sign * 0.0;
  }
  if (error != std::errc()) return {};
  return v;
}

std::optional<int64_t> parse_int(std::string_view s) {
  s = without_plus(trim(s));
  int64_t v = 0;
  const auto [end, error] = std::from_chars(s.data(), s.data() + s.size(), v);
  if (s.empty() || error != std::errc() || end != s.data() + s.size()) return {};
  return v;
}

std::optional<bool> parse_bool(std::string_view s) {
  const std::string t = to_lower(trim(s));
  if (t == "true" || t == "yes" || t == "on" || t == "1") return true;
  if (t == "false" || t == "no" || t == "off" || t == "0") return false;
  return {};
}

std::optional<uint64_t> parse_bytes(std::string_view s) {
  s = trim(s);
  int shift = 0;
  if (!s.empty()) {
    switch (std::toupper(static_cast<unsigned char>(s.back()))) {
      case 'K': shift = 10; break;
      case 'M': shift = 20; break;
      case 'G': shift = 30; break;
      case 'T': shift = 40; break;
    }
  }
  if (shift) s.remove_suffix(1);
  const auto v = parse_double(s);
  if (!v || !(*v >= 0) || *v * double(uint64_t(1) << shift) > 9e18) return {};
  return uint64_t(*v * double(uint64_t(1) << shift));
}

std::string exact_number(double v) {
  char b[40];
  const auto r = std::to_chars(b, b + sizeof b, v);
  return std::string(b, r.ptr);
}

std::string short_number(double v, int digits) {
  if (v == 0) return "0";
  char b[64];
  const auto r = std::to_chars(b, b + sizeof b, v, std::chars_format::general, digits);
  return std::string(b, r.ptr);
}

std::string formatted_number(double v, std::string_view format) {
  std::string_view rest = format;
  if (rest.starts_with('%')) rest.remove_prefix(1);
  int precision = 6;
  if (rest.starts_with('.')) {
    const auto number = parse_int(rest.substr(1, rest.empty() ? 0 : rest.size() - 2));
    precision = number ? int(std::clamp<int64_t>(*number, -1, 31)) : -1;
    rest = rest.substr(rest.size() - 1);
  }
  if (precision < 0 || precision > 30 || (rest != "f" && rest != "g" && rest != "e"))
    fail_usage(fmt::format("'{}' is not a format of numbers", format), "format", "write e.g. .2f, .3g or .1e");
  return rest == "f"   ? fmt::format("{:.{}f}", v, precision)
         : rest == "g" ? fmt::format("{:.{}g}", v, precision)
                       : fmt::format("{:.{}e}", v, precision);
}

std::string human_bytes(uint64_t bytes) {
  const char* unit[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  double v = double(bytes);
  int u = 0;
  while (v >= 1024 && u < 4) v /= 1024, ++u;
  return u == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", v, unit[u]);
}

std::string json_string(std::string_view s) {
  // Names may hold any bytes: the text is UTF-8 all the same, and does nothing to a terminal that it is printed on.
  const std::string text = text_of_bytes(s);
  std::string r = "\"";
  for (size_t i = 0; i < text.size();) {
    uint32_t c = 0;
    const size_t n = decode_utf8(text, i, c);
    if (c == '"' || c == '\\') r += '\\', r += char(c);
    else if (c == '\n') r += "\\n";
    else if (c == '\t') r += "\\t";
    else if (!is_control(c)) r.append(text, i, n);
    else if (c < 0x10000) r += fmt::format("\\u{:04x}", c);
    else r += fmt::format("\\u{:04x}\\u{:04x}", 0xd7c0 + (c >> 10), 0xdc00 + (c & 0x3ff));
    i += n;
  }
  return r + '"';
}

}  // namespace sg
