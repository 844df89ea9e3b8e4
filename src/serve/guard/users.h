// SPDX-License-Identifier: Apache-2.0
// Those who may come in, with a token each. A file of users has one a line: NAME RIGHTS HASH, as in "anna edit sha256:9f86d0...". It holds
// no token, so that who reads it cannot come in.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "serve/guard/rights.h"

namespace sg::serve {

struct User {
  std::string name;
  Rights rights = Rights::view;
  std::string hash;  ///< token_hash() of the token
};

/// The line of a user, with its end. Throws Error(usage) for a name with other signs than letters, digits, ".", "-", "_", "@".
std::string user_line(std::string_view name, Rights rights, std::string_view token);
/// The users of such a file's text; blank lines and those with # in front are left out. Throws Error(data) naming `path` and the line, for
/// what is no user, a name or token that comes twice, more than 10,000 users.
std::vector<User> parse_users(std::string_view text, const std::string& path);
/// The same of a file. Throws Error(data) as well when others than its owner may write it, and when it is larger than 4 MiB.
std::vector<User> read_users(const std::string& path);

}  // namespace sg::serve
