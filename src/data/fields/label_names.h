// SPDX-License-Identifier: Apache-2.0
// Names of numbers that stand for things: the note "labels of FIELD" of a dataset, lines of "number=name".
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace sg {

/// Collects the names of a field's numbers.
class LabelNames {
 public:
  explicit LabelNames(std::string_view field) : note_("labels of " + std::string(field), "") {}
  void add(int64_t number, std::string name) {
    std::replace(name.begin(), name.end(), '\n', ' ');
    note_.second += fmt::format("{}{}={}", note_.second.empty() ? "" : "\n", number, name);
  }
  bool empty() const { return note_.second.empty(); }
  const std::pair<std::string, std::string>& note() const { return note_; }

 private:
  std::pair<std::string, std::string> note_;
};

/// The names that a note `text` ("number=name" lines) tells.
inline std::map<double, std::string> names_in_note(std::string_view text) {
  std::map<double, std::string> names;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size()), equal = text.find('=', begin);
    double number = 0;
    if (equal < end && std::from_chars(text.data() + begin, text.data() + equal, number).ec == std::errc())
      names[number] = text.substr(equal + 1, end - equal - 1);
    begin = end + 1;
  }
  return names;
}

}  // namespace sg
