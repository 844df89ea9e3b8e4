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

/// What other programs can do and this one cannot.
struct MissingName {
  std::string_view words;    ///< as in OtherName
  std::string_view what;     ///< completes "there is no operation that ..."
  std::string_view nearest;  ///< as OtherName::here, with a word on what it does instead; "" = nothing is near
};
std::span<const MissingName> missing_names();

/// How a thing is said here that another program calls `name`, or that there is nothing like it; "" for a name that none has.
std::string known_elsewhere(std::string_view name);
/// How a thing is said here that another program calls `name`; else what unknown_name_hint() says.
std::string said_here(std::string_view name, std::span<const std::string> candidates);

}  // namespace sg
