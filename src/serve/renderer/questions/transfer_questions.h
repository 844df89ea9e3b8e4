// SPDX-License-Identifier: Apache-2.0
// What a window asks about the look of a volume.
#pragma once
#include "base/text/json.h"
#include "pipeline/picture/prepare.h"

namespace sg::serve {

/// "proposals": looks that suit the data, as words, each with its reason: what histogram and boundaries tell, and the presets.
Json::Members answer_proposals(const Json& question, const PreparedPicture& prepared, Context& context);
/// "plane": counts over value and second axis, be it a second field, or the gradient's magnitude where the volume has none. Throws
/// Error(usage) where no volume is shown.
Json::Members answer_plane(const Json& question, const PreparedPicture& prepared, Context& context);

}  // namespace sg::serve
