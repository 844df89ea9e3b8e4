// SPDX-License-Identifier: Apache-2.0
// Changes of a pipeline as a window states them (docs/protocol.md).
#pragma once
#include <string>
#include <vector>

#include "base/text/json.h"
#include "pipeline/file/pipeline_file.h"

namespace sg::serve {

/// Why an edit cannot be, and at which control.
struct EditMistake {
  std::string at;    ///< "show/0", "steps/contour1", "picture"; "" where it belongs to none
  std::string word;  ///< the parameter; "" where it belongs to none
  std::string text;
};

/// The pipeline with all of the edits made; where `mistakes` is filled the result is to be dropped. Words are checked against the schema
/// of what they are set on, not against the data.
PipelineFile edited(PipelineFile file, const Json& edits, std::vector<EditMistake>& mistakes);

/// The files that a pipeline reads, as its words name them.
std::vector<std::string> files_read(const PipelineFile& file);

/// What `after` may not do that `before` does not do: read other files, or write any.
std::vector<EditMistake> forbidden(const PipelineFile& before, const PipelineFile& after);

}  // namespace sg::serve
