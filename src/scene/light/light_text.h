// SPDX-License-Identifier: Apache-2.0
// Lights and the environment as a picture's words have them, taken apart into kinds and words and put together again: for those who edit
// one of them. Whether there are such kinds and words is for parse_lights() and parse_environment() to say.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sg {

/// The kind of environment that a picture of all directions is.
inline constexpr std::string_view picture_environment = "panorama";

/// One light, or the environment.
struct LightText {
  std::string kind;
  std::vector<std::string> words;  ///< "key=value"
  friend bool operator==(const LightText&, const LightText&) = default;
};

/// "sphere from=left; sun": one for each. Throws Error(usage) for a quote that is not closed.
std::vector<LightText> lights_of_text(const std::string& text);
/// Nothing where the text is empty; the name of a file alone is that word of a panorama.
std::optional<LightText> environment_of_text(const std::string& text);

/// What the functions above read back to the same; not for values with a semicolon, nor with both kinds of quotes.
std::string text_of_light(const LightText& light);
std::string text_of_lights(const std::vector<LightText>& lights);

}  // namespace sg
