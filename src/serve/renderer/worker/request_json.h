// SPDX-License-Identifier: Apache-2.0
// Requests for pictures and the pictures, as they pass between processes.
#pragma once
#include "serve/renderer/renderer.h"

namespace sg::serve {

Json request_json(const DrawRequest& request);
/// Throws Error(usage) for a camera that is none.
DrawRequest request_from(const Json& json);
/// All but the bytes.
Json drawn_json(const DrawnView& drawn);
DrawnView drawn_from(const Json& json, std::string bytes);

}  // namespace sg::serve
