// SPDX-License-Identifier: Apache-2.0
// One scale for the glyphs of all parts of a collection.
#pragma once
#include <string>
#include <vector>

#include "data/dataset.h"

namespace sg {

/// `words`: those of `--show glyphs`, for each part. Adds what makes the parts one picture: the same length for the same value (the factor
/// that suits the part with the most glyphs, for the largest value of all parts), and glyphs by the share of space that a part takes, as
/// many in all as one mesh has. Words that state size, factor, places or their number stay as they are.
void take_one_glyph_scale(const std::vector<DatasetPtr>& parts, std::vector<std::vector<std::string>>& words);

}  // namespace sg
