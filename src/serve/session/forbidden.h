// SPDX-License-Identifier: Apache-2.0
// Which files a pipeline reads and writes, and that a window gets it no other ones.
#pragma once
#include <string>
#include <vector>

#include "pipeline/file/pipeline_file.h"
#include "serve/session/edits/edit_words.h"

namespace sg::serve {

/// The files that a pipeline reads, as its words name them.
std::vector<std::string> files_read(const PipelineFile& file);

/// What `after` may not do that `before` does not do: read other files, or write any.
std::vector<EditMistake> forbidden(const PipelineFile& before, const PipelineFile& after);

}  // namespace sg::serve
