// SPDX-License-Identifier: Apache-2.0
// Names of numbers that stand for things: the note "labels of FIELD" of a dataset, lines of "number=name".
#pragma once
#include <fmt/format.h>

#include <algorithm>
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

}  // namespace sg
