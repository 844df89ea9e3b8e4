// SPDX-License-Identifier: Apache-2.0
// What parameters and choices are called in other programs.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace sg {

/// unknown_name_hint(), but where another program calls one of `candidates` so, that one is named first.
std::string other_word_hint(std::string_view name, std::span<const std::string> candidates);
/// The one among `candidates` that means the same; "" for none.
std::string same_word(std::string_view name, std::span<const std::string> candidates);

}  // namespace sg
