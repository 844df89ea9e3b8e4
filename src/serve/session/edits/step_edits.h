// SPDX-License-Identifier: Apache-2.0
// Edits of the steps of a pipeline and of what they take.
#pragma once
#include <string>

#include "pipeline/file/pipeline_file.h"
#include "serve/session/edits/edit_words.h"

namespace sg::serve {

/// Whether an edit's place is a step, as "steps/contour1", there or not.
bool is_step_place(const std::string& at);
/// Null where there is none.
PipelineFile::Step* step_named(PipelineFile& file, std::string_view name);

void set_step(PipelineFile& file, const std::string& at, const Json& set, std::vector<EditMistake>& mistakes);

/// Gives a step other inputs, all of them by name. What hangs on the step is none: that would be a circle. Steps keep their order as far as
/// each still stands behind its inputs.
void connect_step(PipelineFile& file, const std::string& at, const Json& from, std::vector<EditMistake>& mistakes);

/// "operation" of the steps "from", with "set". In front of the places in "before", steps, shows and nodes that took its first input: they
/// take the new step in its place. "" where it cannot be, else its name.
std::string add_step(PipelineFile& file, const Json& edit, std::vector<EditMistake>& mistakes);

/// With what is shown of it. The places in "join" take its first input in its place; a step that takes it otherwise keeps it from going.
void remove_step(PipelineFile& file, const std::string& at, const Json& join, std::vector<EditMistake>& mistakes);

}  // namespace sg::serve
