// SPDX-License-Identifier: Apache-2.0
// What lies at the six sides of the box.
#pragma once
#include <array>
#include <string>

#include "base/schema/enum_words.h"
#include "base/vec.h"

namespace sg::fluid {

enum class SideKind {
  slip,    ///< a wall along which the flow slips
  held,    ///< a wall that friction holds the flow at, which moves along itself with the velocity
  inflow,  ///< flow comes in (or is sucked out) with the velocity
  open,    ///< free space in which the pressure is 0
};
constexpr auto enum_words(SideKind) {
  using enum SideKind;
  return std::array{Word{"slip", slip}, Word{"held", held}, Word{"inflow", inflow}, Word{"open", open}};
}

struct Side {
  SideKind kind = SideKind::slip;
  Vec3 velocity{0, 0, 0};

  /// Whether what flows along the side is held at it.
  bool holds() const { return kind == SideKind::held || kind == SideKind::inflow; }
};
/// x0 x1 y0 y1 z0 z1.
using Sides = std::array<Side, 6>;

/// Sides as text: 'SIDE KIND [VX,VY,VZ]; ...'; what is not named is as in `others`. Throws Error(usage) naming `who`.
Sides sides_of_text(const std::string& text, Sides others, const std::string& who);

}  // namespace sg::fluid
