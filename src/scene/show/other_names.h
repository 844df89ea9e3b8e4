// SPDX-License-Identifier: Apache-2.0
// What operations and ways to show are called in other programs, and ways to show and operations that were taken for each other.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace sg {

struct OtherName {
  std::string_view words;  ///< names elsewhere, lower case without '_' and '-', with a space between two
  std::string_view here;   ///< how to say it, as a flag of the command line
};
std::span<const OtherName> other_names();

/// How a thing is said here that another program calls `name`; else what unknown_name_hint() says.
std::string said_here(std::string_view name, std::span<const std::string> candidates);

}  // namespace sg
