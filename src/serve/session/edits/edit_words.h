// SPDX-License-Identifier: Apache-2.0
// Words of a step, a way to show, a light, a node as an edit sets them.
#pragma once
#include <string>
#include <vector>

#include "base/schema/schema.h"
#include "base/text/json.h"

namespace sg::serve {

/// Why an edit cannot be, and at which control.
struct EditMistake {
  std::string
      at;  ///< "show/0", "steps/contour1", "picture", "lights/0", "environment", "scene/lid", "keys/0/lid"; "" where it belongs to none
  std::string word;  ///< the parameter; "" where it belongs to none
  std::string text;
};

/// Sets words, and with null takes them away. Each is checked by itself, so that a mistake is told at its control.
void set_words(const std::string& at, const Json& set, Schema& schema, std::vector<std::string>& words, std::vector<EditMistake>& mistakes);

/// What is wrong with words together: at the one that was set, where it was a single one.
EditMistake mistake_of_set(const std::string& at, const Json& set, const std::string& text);

}  // namespace sg::serve
