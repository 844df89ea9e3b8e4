// SPDX-License-Identifier: Apache-2.0
// The number that a window gives one of its views, as a message has it.
#pragma once
#include <fmt/core.h>

#include <optional>

#include "base/error.h"
#include "base/text/json.h"
#include "serve/session/limits.h"

namespace sg::serve {

/// Nothing for what is none; 0 where nothing is stated.
inline std::optional<int> view_number(const Json& view) {
  const double n = view.number();
  return n >= 0 && n < most_views ? std::optional(int(n)) : std::nullopt;
}

inline int stated_view(const Json& view) {
  const auto number = view_number(view);
  if (!number) fail_usage(fmt::format("a window has views 0 to {}", most_views - 1));
  return *number;
}

}  // namespace sg::serve
