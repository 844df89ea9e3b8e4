// SPDX-License-Identifier: Apache-2.0
// Meshes in blocks with sets of their sides and nodes, as Exodus files hold them.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"
#include "pipeline/file/pipeline_file.h"

namespace sg {

/// Of data in blocks with sets of sides and nodes the blocks alone, unless parts were chosen by name on the way to `step` or one of
/// `fields` is in none of the blocks: `data` and `step` become those after a step that extracts them (in `file`), and a note tells of it.
/// False where nothing changes.
bool leave_out_sets(PipelineFile& file, std::string& step, Data& data, const std::vector<std::string>& fields,
                    std::vector<std::string>& notes, Context& context);

}  // namespace sg
