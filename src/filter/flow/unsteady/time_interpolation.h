// SPDX-License-Identifier: Apache-2.0
// What a flow is between the time steps that are given.
#pragma once
#include <cstdint>

#include "base/schema/enum_words.h"

namespace sg {

enum class TimeInterpolation : uint8_t { linear, cubic };
constexpr auto enum_words(TimeInterpolation) {
  return std::array{Word{"linear", TimeInterpolation::linear}, Word{"cubic", TimeInterpolation::cubic}};
}

}  // namespace sg
