// SPDX-License-Identifier: Apache-2.0
// Cameras and lights of the files that a picture shows, where it asks for them.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "pipeline/picture/picture_parts.h"

namespace sg {

/// Puts the camera that `camera file=` names, and the lights of `lights: [file]`, into what is stated: of the files that steps read, in
/// their order. What is stated besides of a camera stays. `box`: of the data; a point or spot of the file is as bright as its candela at
/// the middle of it. Throws Error(usage) for a name that no file has, and where no file has any.
void take_from_files(const PipelineFile& file, const Box3& box, StatedPicture& stated, std::vector<std::string>& notes, Context& context);

/// That the files have cameras and lights which the picture does not use; "" where it does, states its own, or they have none.
std::string note_of_file_scene(const std::vector<Data>& results, const PipelineFile& file);

}  // namespace sg
