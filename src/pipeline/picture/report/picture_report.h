// SPDX-License-Identifier: Apache-2.0
// What a picture is drawn of, for --verbose.
#pragma once
#include <string>

#include "render/render.h"
#include "scene/scene.h"

namespace sg {

/// "5120 triangles, 12 line segments, 300 points, 80 glyphs, 1 volume by rays through 921600 pixels": what there is of it; else "nothing".
std::string drawn_text(const Scene& scene, const RenderOptions& options);

}  // namespace sg
