// SPDX-License-Identifier: Apache-2.0
// A picture drawn by squares of 8 x 8 pixels, each until its own error is small enough.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "base/context.h"
#include "image/image.h"
#include "render/trace/integrators/integrator.h"
#include "render/trace/integrators/picture_camera.h"
#include "render/trace/light_options.h"
#include "render/trace/progress/light_watch.h"
#include "render/trace/progress/sweeps.h"
#include "render/trace/studio.h"

namespace sg::trace {

/// What a picture is drawn of.
struct LitPicture {
  const World& world;
  const PictureCamera& camera;
  const Backdrop& backdrop;
  std::vector<Vec3f> around;  ///< of each row: the background that is seen where nothing is met
  const LightOptions& options;
  const Frame* marks = nullptr;  ///< before that, or before the backdrop
};

/// Sums over the paths of a pixel.
struct PixelSum {
  Vec3 light, behind;                      // of what is met, and of what lies around the scene
  double passed = 0, sum = 0, square = 0;  // of the luminance of both

  /// `around`: what is seen where nothing is met.
  void add(const Estimate& e, Vec3f around);
  double mean(uint32_t n) const { return sum / n; }
  /// Of the mean of n > 1.
  double variance(uint32_t n) const;
};

/// Adds what is seen behind the light of a frame, three numbers a pixel, which then is opaque.
void add_behind(const Plane<float>& behind, Frame& frame);

/// Fills a frame with linear premultiplied light and what the middle of each pixel sees, `behind` with what is seen of the backdrop (empty
/// where there is none), `variance` with those of the pixels' luminance, and the report, whose plane of errors has the frame's size. In one
/// go, or where sweeps are wanted as many paths everywhere at a time, with the same bytes; from sweeps.so_far() on, where something was
/// left there by the same picture, which leaves it there when it is cancelled. The same bytes for any number of threads.
void draw_squares(const LitPicture& picture, const Integrator& integrator, Sweeps& sweeps, Frame& frame, Plane<float>& behind,
                  Plane<float>& variance, TraceReport& report, Context& context);

}  // namespace sg::trace
