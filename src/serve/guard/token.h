// SPDX-License-Identifier: Apache-2.0
// Secrets that nobody guesses.
#pragma once
#include <string>
#include <string_view>

namespace sg::serve {

/// 256 bits from the system as 43 letters, digits, "-" and "_".
std::string new_token();
/// "sha256:" and 64 hexadecimal digits. A token has too many bits to be tried out, so that no slow hash is needed.
std::string token_hash(std::string_view token);
/// Whether they are the same; how long it takes depends on their lengths alone.
bool same_secret(std::string_view a, std::string_view b);

}  // namespace sg::serve
