// SPDX-License-Identifier: Apache-2.0
// The names of the schemes by which things with inertia are moved on in time.
#pragma once
#include <array>
#include <cstdint>

#include "base/schema/enum_words.h"

namespace sg {

enum class Integrator : uint8_t { forward_euler, backward_euler, symplectic_euler, verlet, rk4 };
constexpr auto enum_words(Integrator) {
  using enum Integrator;
  return std::array{Word{"forward_euler", forward_euler}, Word{"backward_euler", backward_euler},
                    Word{"symplectic_euler", symplectic_euler}, Word{"verlet", verlet}, Word{"rk4", rk4}};
}

/// Order of the error of a whole path: 1, 1, 1, 2, 4.
constexpr int order_of(Integrator i) {
  constexpr int order[] = {1, 1, 1, 2, 4};
  return order[int(i)];
}

}  // namespace sg
