// SPDX-License-Identifier: Apache-2.0
#include "cli/hints/step_files.h"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "base/error.h"
#include "io/file_series.h"

namespace sg {

namespace {

bool is_figure(char c) { return c >= '0' && c <= '9'; }

// A name as texts and numbers by turns, beginning with a text.
std::vector<std::string_view> pieces_of(std::string_view name) {
  std::vector<std::string_view> pieces;
  size_t begin = 0;
  while (begin <= name.size()) {
    const bool number = pieces.size() % 2 == 1;
    size_t end = begin;
    while (end < name.size() && is_figure(name[end]) == number) ++end;
    pieces.push_back(name.substr(begin, end - begin));
    if (end == name.size()) break;
    begin = end;
  }
  return pieces;
}

// The name with a mark in the place of each number that is not the same in all; "" where texts differ.
std::string common_pattern(const std::vector<std::string>& paths) {
  std::vector<std::vector<std::string_view>> all;
  for (const std::string& p : paths) all.push_back(pieces_of(p));
  std::vector<size_t> varying;
  for (size_t i = 0; i < all[0].size(); ++i)
    for (const auto& pieces : all) {
      if (pieces.size() != all[0].size()) return "";
      if (pieces[i] == all[0][i]) continue;
      if (i % 2 == 0) return "";
      if (varying.empty() || varying.back() != i) varying.push_back(i);
    }
  std::string pattern;
  for (size_t i = 0; i < all[0].size(); ++i) {
    const bool varies = std::find(varying.begin(), varying.end(), i) != varying.end();
    pattern += varies ? (varying.size() == 1 ? "{n}" : "*") : std::string(all[0][i]);
  }
  return varying.empty() ? "" : pattern;
}

}  // namespace

std::string as_series(const std::vector<std::string>& paths) {
  constexpr size_t few = 3;
  if (paths.size() < few) return "";
  const std::string pattern = common_pattern(paths);
  if (pattern.empty()) return "";
  try {
    if (names_series(pattern) && series_files(pattern).size() == paths.size())
      return fmt::format("'{}' in quotes, or --series FILES...", pattern);
  } catch (const Error&) {  // files that are not there are found out when they are read
  }
  return "--series FILES...";
}

}  // namespace sg
