// SPDX-License-Identifier: Apache-2.0
// Changes of a pipeline as a window states them (docs/protocol.md).
#pragma once
#include <string>
#include <vector>

#include "base/text/json.h"
#include "pipeline/file/pipeline_file.h"
#include "serve/session/edits/edit_words.h"

namespace sg::serve {

/// The pipeline with all of the edits made; where `mistakes` is filled the result is to be dropped. Words are checked against the schema
/// of what they are set on, not against the data.
PipelineFile edited(PipelineFile file, const Json& edits, std::vector<EditMistake>& mistakes);

}  // namespace sg::serve
