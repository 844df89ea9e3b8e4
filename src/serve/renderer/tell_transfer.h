// SPDX-License-Identifier: Apache-2.0
// How values become colours and opacity, as the window's editor shows it.
#pragma once
#include "base/text/json.h"
#include "pipeline/picture/prepare.h"

namespace sg::serve {

/// "transfer" of the message "state": of the first item of the show with that number, from 1, that is coloured by a field; null for others.
Json tell_transfer(const PreparedPicture& prepared, uint32_t show, Context& context);

}  // namespace sg::serve
