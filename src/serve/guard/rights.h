// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "base/schema/enum_words.h"

namespace sg::serve {

enum class Rights {
  view,  ///< looks, turns and asks; changes nothing that others see
  edit,
};
constexpr auto enum_words(Rights) { return std::array{Word{"view", Rights::view}, Word{"edit", Rights::edit}}; }

}  // namespace sg::serve
