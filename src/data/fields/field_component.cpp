// SPDX-License-Identifier: Apache-2.0
#include "data/fields/field_component.h"

#include <fmt/core.h>

#include "base/error.h"

namespace sg {

void check_component(const Field& field, int component, std::string_view where) {
  const int n = field.components();
  if (component < n) return;
  fail_usage(fmt::format("field '{}' has {} component{}; there is no component {}", field.name, n, n == 1 ? "" : "s", component),
             std::string(where), n == 1 ? "leave out component" : fmt::format("0 to {}, or -1 for the magnitude", n - 1));
}

}  // namespace sg
