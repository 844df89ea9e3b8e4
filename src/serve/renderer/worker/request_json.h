// SPDX-License-Identifier: Apache-2.0
// Requests for pictures and the pictures, as they pass between processes.
#pragma once
#include <array>

#include "base/schema/enum_words.h"
#include "serve/renderer/renderer.h"

namespace sg::serve {

/// The functions of a renderer, "call" of a message.
enum class Call { start, load, tell, draw, forget, answer, save };
constexpr auto enum_words(Call) {
  using enum Call;
  return std::array{Word{"start", start},   Word{"load", load},     Word{"tell", tell}, Word{"draw", draw},
                    Word{"forget", forget}, Word{"answer", answer}, Word{"save", save}};
}

Json request_json(const DrawRequest& request);
/// Throws Error(usage) for a camera that is none.
DrawRequest request_from(const Json& json);
/// All but the bytes.
Json drawn_json(const DrawnView& drawn);
DrawnView drawn_from(const Json& json, std::string bytes);

}  // namespace sg::serve
