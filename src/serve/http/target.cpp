// SPDX-License-Identifier: Apache-2.0
#include "serve/http/target.h"

#include "base/text/text.h"
#include "base/text/utf8.h"

namespace sg::serve {

namespace {

constexpr size_t most_words = 32, most_cookies = 8;

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool has_control(std::string_view text) {
  for (const unsigned char c : text)
    if (c < 0x20 || c == 0x7f) return true;
  return false;
}

}  // namespace

std::optional<std::string> percent_decoded(std::string_view text, bool plus_is_blank) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%') {
      if (text.size() - i < 3) return {};
      const int high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
      if (high < 0 || low < 0) return {};
      out += char(high * 16 + low);
      i += 2;
    } else {
      out += plus_is_blank && text[i] == '+' ? ' ' : text[i];
    }
  }
  if (has_control(out) || !is_utf8(out)) return {};
  return out;
}

std::optional<Target> parse_target(std::string_view text) {
  if (text.empty() || text[0] != '/' || text.find('#') != text.npos) return {};
  const size_t mark = text.find('?');
  auto path = percent_decoded(text.substr(0, mark));
  if (!path) return {};
  Target target{std::move(*path), {}};
  std::string_view rest = mark == text.npos ? std::string_view() : text.substr(mark + 1);
  while (!rest.empty()) {
    const size_t end = rest.find('&');
    const std::string_view word = rest.substr(0, end);
    rest = end == rest.npos ? std::string_view() : rest.substr(end + 1);
    if (word.empty()) continue;
    const size_t equals = word.find('=');
    auto key = percent_decoded(word.substr(0, equals), true);
    auto value = percent_decoded(equals == word.npos ? std::string_view() : word.substr(equals + 1), true);
    if (!key || !value || target.query.size() == most_words) return {};
    target.query.emplace_back(std::move(*key), std::move(*value));
  }
  return target;
}

std::vector<std::string_view> cookie_values(std::string_view header, std::string_view name) {
  std::vector<std::string_view> values;
  while (!header.empty() && values.size() < most_cookies) {
    const size_t end = header.find(';');
    const std::string_view pair = trim(header.substr(0, end));
    header = end == header.npos ? std::string_view() : header.substr(end + 1);
    if (const size_t equals = pair.find('='); equals != pair.npos && pair.substr(0, equals) == name)
      values.push_back(pair.substr(equals + 1));
  }
  return values;
}

}  // namespace sg::serve
