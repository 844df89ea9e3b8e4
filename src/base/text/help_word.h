// SPDX-License-Identifier: Apache-2.0
// A word of a small language, for help: functions and operators of expressions.
#pragma once
#include <string_view>

namespace sg {

struct HelpWord {
  std::string_view group;     ///< "operator", "function", "name"
  std::string_view form;      ///< as one writes it: "clamp(a, b, c)"
  std::string_view sentence;  ///< what it is
};

}  // namespace sg
