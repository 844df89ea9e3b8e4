// SPDX-License-Identifier: Apache-2.0
// Texts that ask for the time: "t = {t}", "t = {t:.2f} s".
#pragma once
#include <string>
#include <string_view>

namespace sg {

/// Whether a text asks for the time.
bool has_time_mark(std::string_view text);
/// The time in its places: a short number, or as formatted_number() has it where a format stands behind a colon. Throws Error(usage) for a
/// format that is none.
std::string with_time(std::string text, double time);
/// A word in braces that nothing stands for, such as "{time}"; "" for none.
std::string unknown_mark(std::string_view text);

}  // namespace sg
