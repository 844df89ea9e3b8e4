// SPDX-License-Identifier: Apache-2.0
// Numbers and words as text, locale-free.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sg {

std::string_view trim(std::string_view s);
std::string to_lower(std::string_view s);
bool equal_ignoring_case(std::string_view a, std::string_view b);
/// Parts between separators, each trimmed; "" has no parts.
std::vector<std::string_view> split(std::string_view s, char separator);
/// Words between blanks.
std::vector<std::string_view> words(std::string_view s);
/// Words between blanks; '...' and "..." keep blanks (a missing closing quote is a usage error).
std::vector<std::string> quoted_words(std::string_view s);

/// The whole of s as a number ("1e3", "-.5", "nan", "inf"); nothing when it is not one.
std::optional<double> parse_double(std::string_view s);
std::optional<int64_t> parse_int(std::string_view s);
/// "true/false", "yes/no", "on/off", "1/0".
std::optional<bool> parse_bool(std::string_view s);
/// "512M", "2G", "1048576": bytes, powers of 1024.
std::optional<uint64_t> parse_bytes(std::string_view s);

/// Shortest text that reads back as the same double ("0.1", "1e+20").
std::string exact_number(double v);
/// At most `digits` significant digits, no trailing zeros ("0.333").
std::string short_number(double v, int digits = 6);
/// As printf writes "%.2f", "%.3g" or "%.1e"; the percent sign may be left out. Throws Error(usage) for another format.
std::string formatted_number(double v, std::string_view format);
/// "64.0 MiB".
std::string human_bytes(uint64_t bytes);
/// s as a JSON string with its quotes.
std::string json_string(std::string_view s);

}  // namespace sg
