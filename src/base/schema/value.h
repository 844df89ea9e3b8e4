// SPDX-License-Identifier: Apache-2.0
// Value: what a parameter is set to, as passed by every interface.
#pragma once
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace sg {

/// std::monostate: not given, so that the operation chooses ("auto" in text, null in JSON).
using Value =
    std::variant<std::monostate, bool, int64_t, double, std::string, std::vector<int64_t>, std::vector<double>, std::vector<std::string>>;

/// As parameters are written: "auto", "true", "0.1", "1,2,3".
std::string value_text(const Value& value);
/// As JSON; numbers that JSON does not know (infinities, NaN) as strings.
std::string value_json(const Value& value);

}  // namespace sg
