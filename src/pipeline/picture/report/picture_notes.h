// SPDX-License-Identifier: Apache-2.0
// Texts in pictures as one word states them.
#pragma once
#include <string>
#include <vector>

#include "render/annotate/notes.h"

namespace sg {

/// "Inlet @ 0.1,0.9; Outlet @ top-right size=1.5 color=red": texts with their places, apart by semicolons ("\;" is one in a text); the
/// last "@" of each ends the text, and without one it stands at the top left. Throws Error(usage) for what is no place, no text, or more
/// than 100 of them.
std::vector<PictureNote> parse_notes(const std::string& text);

}  // namespace sg
