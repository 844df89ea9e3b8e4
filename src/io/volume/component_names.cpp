// SPDX-License-Identifier: Apache-2.0
#include "io/volume/component_names.h"

#include <algorithm>
#include <cctype>
#include <unordered_map>

namespace sg {

namespace {

using Places = std::unordered_map<std::string, size_t>;

// All of stem + end for the given ends, or nothing.
std::vector<size_t> members(const Places& places, const std::vector<bool>& used, const std::string& stem, bool upper,
                            std::initializer_list<const char*> ends) {
  std::vector<size_t> found;
  for (const char* end : ends) {
    std::string e = end;
    if (upper)
      for (char& c : e) c = char(std::toupper(c));
    const auto at = places.find(stem + e);
    if (at == places.end() || used[at->second]) return {};
    found.push_back(at->second);
  }
  return found;
}

}  // namespace

std::vector<NameGroup> group_components(const std::vector<std::string>& names, bool flat) {
  std::vector<NameGroup> groups;
  std::vector<bool> used(names.size(), false);
  Places places;
  for (size_t i = 0; i < names.size(); ++i) places.emplace(names[i], i);
  for (size_t i = 0; i < names.size(); ++i) {
    if (used[i]) continue;
    const std::string& name = names[i];
    NameGroup group{name, {i}};
    const char last = name.empty() ? '\0' : name.back();
    const bool upper = last >= 'X' && last <= 'Z';
    if (upper || (last >= 'x' && last <= 'z')) {
      const std::string one = name.substr(0, name.size() - 1), two = one.empty() ? one : one.substr(0, one.size() - 1);
      std::vector<size_t> found;
      const std::string* stem = &two;
      if (!two.empty()) found = members(places, used, two, upper, {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"});
      if (!two.empty() && found.empty()) found = members(places, used, two, upper, {"xx", "yy", "zz", "xy", "yz", "xz"});
      if (!two.empty() && found.empty()) found = members(places, used, two, upper, {"xx", "yy", "zz", "xy", "yz", "zx"});
      if (found.empty()) stem = &one;
      if (!one.empty() && found.empty()) found = members(places, used, one, upper, {"x", "y", "z"});
      if (!one.empty() && found.empty() && flat) found = members(places, used, one, upper, {"x", "y"});
      if (std::find(found.begin(), found.end(), i) != found.end()) group = {*stem, std::move(found)};
    }
    for (const size_t k : group.members) used[k] = true;
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace sg
