// SPDX-License-Identifier: Apache-2.0
// Edits of the entries of a node: its keys, which say where it is when, and its copies.
#pragma once
#include "pipeline/file/pipeline_file.h"
#include "serve/session/edits/edit_words.h"

namespace sg::serve {

/// Of whom an entry is: of the node `to`.
enum class EntryOf { key, copy, points };

/// Whether an edit's place is an entry: "keys/0/lid", "copies/2/lid", or "points/lid", the copies at the points of a step.
bool is_entry_place(const std::string& at);

void set_entry(PipelineFile& file, const std::string& at, const Json& set, std::vector<EditMistake>& mistakes);
/// To the node "to": a key, where its time puts it among the others; a copy; or copies at the points of the step "of". Copies that are
/// listed and copies at points take the place of each other.
void add_entry(PipelineFile& file, EntryOf kind, const Json& edit, std::vector<EditMistake>& mistakes);
/// With the last key goes the moment that the node shows.
void remove_entry(PipelineFile& file, const std::string& at, std::vector<EditMistake>& mistakes);

}  // namespace sg::serve
