// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/unread.h"

#include <algorithm>
#include <limits>

namespace sg {

Array unread_values(ElementType type, size_t count, int components) {
  static const double nan64 = std::numeric_limits<double>::quiet_NaN();
  static const float nan32 = std::numeric_limits<float>::quiet_NaN();
  static const uint64_t zero = 0;
  const void* p = &zero;
  if (type == ElementType::f64) p = &nan64;
  if (type == ElementType::f32) p = &nan32;
  return Array({nullptr, static_cast<const std::byte*>(p), element_size(type)}, type, count, components, 0, 0, 0);
}

bool is_wanted(const std::vector<std::string>& fields, std::string_view name) {
  return fields.empty() || std::find(fields.begin(), fields.end(), name) != fields.end();
}

}  // namespace sg
