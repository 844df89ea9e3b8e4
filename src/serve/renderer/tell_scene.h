// SPDX-License-Identifier: Apache-2.0
// What a window is told of lights and nodes.
#pragma once
#include "base/text/json.h"
#include "pipeline/file/pipeline_file.h"

namespace sg::serve {

/// "lights", "environment", "scene". Lights that cannot be read are none.
Json::Members tell_scene(const PipelineFile& file);

/// The name of the node in which something is shown; "" where the data lie.
std::string node_of(const PipelineFile& file, const PipelineFile::Show& show);

}  // namespace sg::serve
