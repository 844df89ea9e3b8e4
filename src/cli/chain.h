// SPDX-License-Identifier: Apache-2.0
// The command line as steps of a pipeline file.
#pragma once
#include <string>
#include <vector>

#include "cli/options.h"
#include "pipeline/file/pipeline_file.h"

namespace sg {

/// A chain of steps for each file (or for the source), shown as --show says. In the text of -f
///   NAME: before the operation   names the step
///   on=NAME                      takes that step in place of the one before: a name, "input" (what is read), or an operation of the chain
///   with=A,B                     further inputs: names as above, or files (patterns of series too)
/// and in that of --show of=NAME. Throws Error(usage) for unknown names, with what would be right.
PipelineFile pipeline_of(const Options& o);

/// Words for every way to show that colours by a field: --field, --map, --range, --legend and their like (PictureOptions::coloring). Throws
/// Error(usage).
std::vector<std::string> coloring_words(const Options& o);

}  // namespace sg
