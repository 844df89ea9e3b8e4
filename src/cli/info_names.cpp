// SPDX-License-Identifier: Apache-2.0
#include "cli/info_names.h"

#include <fmt/core.h>

#include "base/text/text.h"
#include "base/text/utf8.h"
#include "data/fields/label_names.h"

namespace sg {

namespace {

std::map<double, std::string> names_of(const Dataset& d, const Field& f) {
  for (const auto& [note, text] : d.notes())
    if (note == "labels of " + f.name) return names_in_note(text);
  return {};
}

}  // namespace

std::string names_text(const Dataset& d, const Field& f, bool quick) {
  constexpr size_t few = 4;
  std::map<double, std::string> names = names_of(d, f);
  if (!quick && !names.empty()) {
    const Range r = d.range(f);
    std::erase_if(names, [&](const auto& name) { return name.first < r.lo || name.first > r.hi; });
  }
  if (names.empty()) return "";
  std::string r;
  size_t shown = 0;
  for (const auto& [number, name] : names) {
    if (shown == few && names.size() > few + 1) break;  // "..." for one alone saves nothing
    r += fmt::format("{}{} = {}", shown++ ? ", " : "; names ", short_number(number), printable(name));
  }
  return shown == names.size() ? r : r + fmt::format(", ... ({} in all)", names.size());
}

std::string names_json(const Dataset& d, const Field& f) {
  std::string r;
  for (const auto& [number, name] : names_of(d, f))
    r += fmt::format("{}{}:{}", r.empty() ? "" : ",", json_string(exact_number(number)), json_string(name));
  return r.empty() ? "" : ",\"names\":{" + r + "}";
}

}  // namespace sg
