// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "pipeline/file/pipeline_file.h"

namespace sg::serve {

/// The pipeline as a command that makes the same picture: "sightglass render head.vti -f 'contour1: contour values=400' ...". "" where
/// several files are read, or none, or where there is a scene: those stand in pipeline files.
std::string command_text(const PipelineFile& file);

}  // namespace sg::serve
