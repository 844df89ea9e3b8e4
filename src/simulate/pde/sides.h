// SPDX-License-Identifier: Apache-2.0
// What happens at the sides of a room.
#pragma once
#include <array>
#include <string>

#include "base/schema/enum_words.h"

namespace sg::pde {

/// held: the value is given. insulated: nothing passes, waves are thrown back. absorbing: waves leave. periodic: the opposite side follows.
/// A held side has no word: it is said by the expression of its values.
enum class SideKind { held, insulated, absorbing, periodic };
constexpr auto enum_words(SideKind) {
  using enum SideKind;
  return std::array{Word{"insulated", insulated}, Word{"reflecting", insulated}, Word{"absorbing", absorbing}, Word{"periodic", periodic}};
}

struct Side {
  SideKind kind = SideKind::insulated;
  std::string value;  ///< of held sides: an expression
  /// Its values lie on the side itself, one spacing away from the nearest unknown.
  bool wall() const { return kind == SideKind::held || kind == SideKind::absorbing; }
};

/// x0 x1 y0 y1 z0 z1.
using Sides = std::array<Side, 6>;

}  // namespace sg::pde
