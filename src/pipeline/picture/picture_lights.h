// SPDX-License-Identifier: Apache-2.0
// The light of a picture beyond its words: the picture of an environment, and what a renderer leaves out.
#pragma once
#include <memory>
#include <string>

#include "base/context.h"
#include "image/linear_picture.h"
#include "pipeline/picture/picture_parts.h"

namespace sg {

/// A picture of all directions: .hdr as it is, others that are read as grids in sRGB (8 and 16 bits) or linear (floating point). Throws
/// Error(data) for a file that is missing, damaged or not a picture of one layer, and for negative and non-finite pixels.
std::shared_ptr<const LinearPicture> read_environment(const std::string& path, Context& context);

/// What is stated of light, lens and paths that the rasterizer does not show; "" for nothing.
std::string note_of_lost_light(const StatedPicture& stated, const Scene& scene);

/// Where volumes are seen in light, and a legend tells of their colours: what these are. "" else.
std::string note_of_lit_matter(const StatedPicture& stated, const Scene& scene, const std::vector<Legend>& legends);

}  // namespace sg
