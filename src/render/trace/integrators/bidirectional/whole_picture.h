// SPDX-License-Identifier: Apache-2.0
// A picture by an integrator that lights it as a whole, pass by pass to a stated error.
#pragma once
#include "base/context.h"
#include "image/image.h"
#include "render/trace/integrators/world.h"
#include "render/trace/light_options.h"
#include "scene/camera.h"

namespace sg::trace {

struct WholePicture {
  Frame frame;
  double paths = 0;  ///< a pixel
  double noise = 0;  ///< standard error as displayed, root mean square over the picture
  bool reached = false;
};

/// Whether an integrator is one of those.
bool lights_whole_picture(IntegratorKind kind);

/// Passes are made until the error of the pixels in which something is seen is below options.noise, root mean square, after four passes at
/// the earliest, or at options.paths. The error of a pixel is that of the mean of the passes; a factor that all pixels share adds its own.
/// The same bytes for any number of threads.
WholePicture draw_whole_picture(const World& world, const Projection& projection, const LightOptions& options, Context& context);

}  // namespace sg::trace
