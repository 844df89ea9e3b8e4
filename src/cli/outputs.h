// SPDX-License-Identifier: Apache-2.0
// What the commands that run a pipeline share: the names of what they write, the plan, and the memory allowed.
#pragma once
#include <string>

#include "cli/options.h"
#include "pipeline/file/pipeline_file.h"

namespace sg {

/// The name of a file or series without folder and extension.
std::string stem_of(const std::string& path);
/// The name with the input's in the place of {name}.
std::string output_name(std::string pattern, const std::string& stem);
/// The plan of the steps; `drawn`: and of the picture.
void print_explanation(const PipelineFile& file, bool drawn = false);
/// With --memory, what the steps are expected to hold together is known before any of them runs. Files in formats of which parts can be
/// read do not count here: they are mapped or cut, and arrays are counted while they are made. Throws Error(usage).
void check_memory(const PipelineGraph& built, const Options& o);

}  // namespace sg
