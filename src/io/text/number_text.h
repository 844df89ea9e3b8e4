// SPDX-License-Identifier: Apache-2.0
// How exact the real numbers of a text are.
#pragma once
#include <string_view>

#include "data/array.h"

namespace sg {

/// f64 when some number among the first bytes of the text has more than 7 significant digits, which f32 cannot keep; else f32.
ElementType real_type_of(std::string_view text);

}  // namespace sg
