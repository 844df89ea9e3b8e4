// SPDX-License-Identifier: Apache-2.0
#include "serve/files/series_groups.h"

#include <map>

namespace sg::serve {

namespace {

constexpr std::string_view number_place = "{n}";
constexpr size_t least_steps = 3;

bool is_number_sign(char c) { return c >= '0' && c <= '9'; }

// The name with its last whole number as {n}; "" when it has none.
std::string series_name(const std::string& name) {
  if (has_series_signs(name)) return "";
  size_t end = name.size();
  // The number in an extension (".h5") counts no steps.
  const size_t dot = name.rfind('.');
  if (dot != name.npos && dot > 0 && name.find_first_not_of("0123456789", dot + 1) != name.npos) end = dot;
  while (end > 0 && !is_number_sign(name[end - 1])) --end;
  size_t begin = end;
  while (begin > 0 && is_number_sign(name[begin - 1])) --begin;
  return begin == end ? "" : name.substr(0, begin) + std::string(number_place) + name.substr(end);
}

}  // namespace

bool has_series_signs(const std::string& text) { return text.find_first_of("*?,\\{}") != text.npos; }

bool split_series_name(const std::string& name, std::string& front, std::string& behind) {
  const size_t at = name.find(number_place);
  if (at == name.npos) return false;
  front = name.substr(0, at);
  behind = name.substr(at + number_place.size());
  return !has_series_signs(front) && !has_series_signs(behind);
}

std::vector<ListedFile> grouped_as_series(const std::vector<ConfinedFolder::Entry>& files) {
  std::map<std::string, ListedFile> series;
  for (const auto& file : files)
    if (std::string name = series_name(file.name); !name.empty()) {
      ListedFile& all = series[name];
      all.series = all.name.empty() ? 1 : all.series + 1;
      all.bytes += file.bytes;
      all.name = std::move(name);
    }
  std::vector<ListedFile> out;
  for (const auto& file : files) {
    const auto found = series.find(series_name(file.name));
    if (found == series.end() || (found->second.series < least_steps && found->second.series > 0))
      out.push_back({file.name, file.bytes, 1});
    else if (found->second.series >= least_steps) {
      out.push_back(found->second);
      found->second.series = 0;  // told
    }
  }
  return out;
}

}  // namespace sg::serve
