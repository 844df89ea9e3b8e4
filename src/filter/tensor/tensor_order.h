// SPDX-License-Identifier: Apache-2.0
// In what order a field holds the numbers of a tensor.
#pragma once
#include <cstdint>

#include "base/schema/enum_words.h"

namespace sg {

enum class TensorOrder : uint8_t {
  rows,    ///< xx xy xz yx yy yz zx zy zz; of four xx xy yx yy
  vtk,     ///< xx yy zz xy yz xz
  upper,   ///< xx xy xz yy yz zz
  lower,   ///< xx xy yy xz yz zz
  voigt,   ///< xx yy zz yz xz xy
  abaqus,  ///< xx yy zz xy xz yz
  masked,  ///< a confidence, then upper
  plane,   ///< xx yy xy
};
constexpr auto enum_words(TensorOrder) {
  using enum TensorOrder;
  return std::array{Word{"rows", rows},   Word{"vtk", vtk},       Word{"upper", upper},   Word{"lower", lower},
                    Word{"voigt", voigt}, Word{"abaqus", abaqus}, Word{"masked", masked}, Word{"plane", plane}};
}

}  // namespace sg
