// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace sg::serve {

/// What /catalog.json holds: everything that can be requested. In a file of its own: the door needs nothing else of pipeline/.
std::string catalog_text();

}  // namespace sg::serve
