// SPDX-License-Identifier: Apache-2.0
// Words that belong to an option but arrive as names of files, as they stand without quotes: -f slice normal=0,0,1, --title A long title.
#pragma once
#include <string>
#include <vector>

namespace sg {

/// Throws Error(usage) with the option as it should be written, where one of `inputs` is no file but a word that is meant for an option
/// of `args` before it. Words that may be names of files pass.
void refuse_loose_words(const std::vector<std::string>& args, const std::vector<std::string>& inputs, const std::string& command);

}  // namespace sg
