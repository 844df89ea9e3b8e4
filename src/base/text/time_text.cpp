// SPDX-License-Identifier: Apache-2.0
#include "base/text/time_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <tuple>

#include "base/text/text.h"

namespace sg {

namespace {

// From `from` on the next "{t}" or "{t:...}": where it begins and ends; npos for none.
std::pair<size_t, size_t> next_time(std::string_view text, size_t from) {
  for (size_t at = text.find("{t", from); at != text.npos; at = text.find("{t", at + 1)) {
    const size_t end = text.find('}', at);
    if (end == text.npos) break;
    if (end == at + 2 || text[at + 2] == ':') return {at, end + 1};
  }
  return {text.npos, text.npos};
}

}  // namespace

bool has_time_mark(std::string_view text) { return next_time(text, 0).first != text.npos; }

std::string with_time(std::string text, double time) {
  for (auto [at, end] = next_time(text, 0); at != text.npos; std::tie(at, end) = next_time(text, at)) {
    const std::string format = end - at > 3 ? text.substr(at + 3, end - at - 4) : "";
    const std::string number = format.empty() ? short_number(time) : formatted_number(time, format);
    text.replace(at, end - at, number);
    at += number.size();
  }
  return text;
}

std::string unknown_mark(std::string_view text) {
  for (size_t at = text.find('{'); at != text.npos; at = text.find('{', at + 1)) {
    const size_t end = text.find('}', at);
    if (end == text.npos) return "";
    const std::string_view word = text.substr(at + 1, end - at - 1);
    const bool letters =
        !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isalpha(c) || c == '_'; });
    constexpr std::array<std::string_view, 4> known{"t", "n", "count", "name"};
    if (letters && std::find(known.begin(), known.end(), word) == known.end()) return std::string(text.substr(at, end + 1 - at));
  }
  return "";
}

}  // namespace sg
