// SPDX-License-Identifier: Apache-2.0
// Scene + Camera -> Frame by paths of light.
#pragma once
#include "base/context.h"
#include "image/image.h"
#include "render/prepare/prepare.h"
#include "render/trace/light_options.h"
#include "render/trace/progress/light_watch.h"
#include "scene/scene.h"

namespace sg {

/// Surfaces, lines, points, glyphs and volumes in the light of the scene: linear and premultiplied, without the background. Pixels are
/// drawn by squares, each until its error is below `noise`; a path belongs to a pixel by where it starts (box filter). Integrators whose
/// paths may end in any pixel finish the picture as a whole (integrators/bidirectional/whole_picture.h). The report has the pixels' errors,
/// before `denoise`. The same bytes for any number of threads, with `watch` and without; options.seconds alone makes a picture that depends
/// on the machine, and report.stopped tells how to have it again. `watch` gets pictures that are not denoised. Throws Error(usage) for
/// volumes that are no matter (another mode than composite), and for options out of range.
/// `marks`: what stands before an environment that is seen, in a frame of the same size (put_marks() puts it on what is transparent).
Frame trace_scene(const Scene& scene, const PreparedScenePtr& prepared, const Projection& projection, const LightOptions& options,
                  TraceReport& report, Context& context, const LightWatch& watch = {}, const Frame* marks = nullptr);

}  // namespace sg
