// SPDX-License-Identifier: Apache-2.0
// Edits of the nodes of a scene, and of what is shown in them.
#pragma once
#include "pipeline/file/pipeline_file.h"
#include "serve/session/edits/edit_words.h"

namespace sg::serve {

/// Whether an edit's place is a node, as "scene/lid", there or not.
bool is_node_place(const std::string& at);

/// The number of a node; -1 for "", where the data lie, and nothing where no node has that name.
std::optional<int> node_named(const PipelineFile& file, const std::string& name);

/// The node by itself: throws Error(usage) for words that cannot be together. Those that wait for the time of a film are left out.
void check_node(PipelineFile::Node node);

void set_node(PipelineFile& file, const std::string& at, const Json& set, std::vector<EditMistake>& mistakes);
/// "name", which may be left open, and the node "in" which it stands, with "set".
void add_node(PipelineFile& file, const Json& edit, std::vector<EditMistake>& mistakes);
/// With the nodes in it and all that they show.
void remove_node(PipelineFile& file, const std::string& at, std::vector<EditMistake>& mistakes);

}  // namespace sg::serve
