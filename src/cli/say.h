// SPDX-License-Identifier: Apache-2.0
// Text for people: whatever names it contains, it cannot affect a terminal.
#pragma once
#include <string>

namespace sg {

/// To standard output, as printable() with line ends.
void say(const std::string& text);
/// One line of standard error.
void say_error(const std::string& text);

}  // namespace sg
