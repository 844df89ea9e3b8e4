// SPDX-License-Identifier: Apache-2.0
// What drawing is expected to take, which no step of the graph counts.
#pragma once
#include <string>

#include "pipeline/file/pipeline_file.h"
#include "pipeline/picture/picture_parts.h"

namespace sg {

/// A line for --explain. By the bytes of what is shown, the pixels and, for volumes, the samples along a ray: right within a factor of a
/// few, as opacity ends rays early.
std::string explain_drawing(const PipelineFile& file, const PipelineGraph& built);

/// Before a volume is drawn within a tolerance that will take long: for how long, why, and what takes less. "" for others.
std::string note_of_long_drawing(const Scene& scene, double pixels, const Context& context);

}  // namespace sg
