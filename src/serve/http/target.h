// SPDX-License-Identifier: Apache-2.0
// The line and the headers of a request as values. What is not of the plain form that browsers send is refused, never mended.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "serve/http/request.h"

namespace sg::serve {

struct Target {
  std::string path;
  Query query;
};

/// "%41" as "A", once. Nothing for a "%" without two hexadecimal digits, and for what is then no UTF-8 or holds control characters.
std::optional<std::string> percent_decoded(std::string_view text, bool plus_is_blank = false);
/// "/files.json?below=a%20b". Nothing for another form ("http://...", "*"), for a "#", for what cannot be decoded, and for more than 32
/// words.
std::optional<Target> parse_target(std::string_view text);
/// The values of the cookies of that name, in the order of the header; at most 8. Other servers on this machine can set cookies of the
/// same name, so that each is to be tried.
std::vector<std::string_view> cookie_values(std::string_view header, std::string_view name);

}  // namespace sg::serve
