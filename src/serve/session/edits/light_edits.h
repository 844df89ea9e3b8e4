// SPDX-License-Identifier: Apache-2.0
// Edits of a picture's lights and environment, which its words hold as texts.
#pragma once
#include "pipeline/file/pipeline_file.h"
#include "serve/session/edits/edit_words.h"

namespace sg::serve {

/// Whether an edit's place is the environment, or as "lights/2" a light, there or not.
bool is_light_place(const std::string& at);

void set_light(PipelineFile& file, const std::string& at, const Json& set, std::vector<EditMistake>& mistakes);
void add_light(PipelineFile& file, const std::string& kind, const Json& set, std::vector<EditMistake>& mistakes);
/// In the place of the one that is there.
void put_environment(PipelineFile& file, const std::string& kind, const Json& set, std::vector<EditMistake>& mistakes);
void remove_light(PipelineFile& file, const std::string& at, std::vector<EditMistake>& mistakes);

}  // namespace sg::serve
