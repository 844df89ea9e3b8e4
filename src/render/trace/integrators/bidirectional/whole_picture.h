// SPDX-License-Identifier: Apache-2.0
// A picture by an integrator that lights it as a whole, pass by pass to a stated error.
#pragma once
#include "base/context.h"
#include "image/image.h"
#include "render/trace/integrators/picture_camera.h"
#include "render/trace/integrators/world.h"
#include "render/trace/light_options.h"
#include "render/trace/progress/light_watch.h"
#include "render/trace/progress/sweeps.h"

namespace sg::trace {

/// Whether an integrator is one of those.
bool lights_whole_picture(IntegratorKind kind);

/// Passes are made until the error of the pixels in which something is seen is below options.noise, root mean square, after four passes at
/// the earliest, or at options.paths. The error of a pixel is that of the mean of the passes; a factor that all pixels share adds its own.
/// Fills `frame`, the variances of the luminance of its pixels, and the report, whose plane of errors has the frame's size. The same bytes
/// for any number of threads.
void draw_whole_picture(const World& world, const PictureCamera& camera, const LightOptions& options, Sweeps& sweeps, Frame& frame,
                        Plane<float>& variances, TraceReport& report, Context& context);

struct WholePicture {
  Frame frame;
  double paths = 0;  ///< a pixel
  double noise = 0;  ///< standard error as displayed, root mean square over the picture
  bool reached = false;
};
/// The same without a look at it on the way.
WholePicture draw_whole_picture(const World& world, const Projection& projection, const LightOptions& options, Context& context);

}  // namespace sg::trace
