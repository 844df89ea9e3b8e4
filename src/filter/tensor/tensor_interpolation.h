// SPDX-License-Identifier: Apache-2.0
// What is interpolated between the points of a tensor field.
#pragma once
#include "base/schema/enum_words.h"

namespace sg {

enum class TensorInterpolation { components, log };
constexpr auto enum_words(TensorInterpolation) {
  return std::array{Word{"components", TensorInterpolation::components}, Word{"log", TensorInterpolation::log}};
}

}  // namespace sg
