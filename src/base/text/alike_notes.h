// SPDX-License-Identifier: Apache-2.0
// What parts of a whole say alike, put together: notes that differ only in their numbers become one.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "base/context.h"

namespace sg {

class AlikeNotes {
 public:
  void add(LogLevel level, std::string_view text);
  /// Logs one note of each kind, in the order in which they came: the first, and how many more of its kind have other numbers. Those go to
  /// the debug level.
  void tell(const Context& context) const;

 private:
  struct Kind {
    LogLevel level;
    std::string form;                ///< without its numbers
    std::vector<std::string> texts;  ///< each once
  };
  std::vector<Kind> kinds_;
};

}  // namespace sg
