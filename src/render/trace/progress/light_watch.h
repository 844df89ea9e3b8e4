// SPDX-License-Identifier: Apache-2.0
// What is told of a picture by paths: what it took, and pictures on the way.
#pragma once
#include <functional>
#include <memory>

#include "image/image.h"

namespace sg {

/// Planes of a picture by paths beside those of its frame.
struct LightPlanes {
  Plane<float> error;   ///< width * height: the standard error of a pixel's luminance as displayed, as a share of full scale
  Plane<float> albedo;  ///< 3 * width * height, where asked for: the colours of what is seen first, linear; 0 where nothing is
  Plane<float> normal;  ///< 3 * width * height, where asked for: x to the right, y up, z to the viewer; the mean over the pixel
};

/// What it took.
struct TraceReport {
  double paths = 0;  ///< a pixel, on average
  double noise = 0;  ///< the standard error as displayed: root mean square over the picture
  bool reached = true;
  int stopped = 0;  ///< where time ended it: paths of each pixel whose noise was not reached; LightOptions::stop makes the same picture
  LightPlanes planes;
};

namespace trace {
struct SquaresSoFar;
}
/// What was drawn of a picture when it was cancelled, for the same scene, camera, size and options: it goes on from there, and has the same
/// bytes in the end. Of those drawn by squares (trace/squares.h) without a time; others begin anew.
struct LightSoFar {
  std::shared_ptr<trace::SquaresSoFar> squares;
  size_t bytes = 0;  ///< that it takes
};

/// Gets the picture while it is drawn: at once with two paths a pixel, then about every so many seconds. False ends it there.
struct LightWatch {
  std::function<bool(const Frame&, const TraceReport&)> on_frame;
  double every = 1;              ///< seconds; with n pictures told, n times as long, so that a long wait brings few
  LightSoFar* so_far = nullptr;  ///< taken at the beginning, filled where the picture is cancelled; not owned
};

}  // namespace sg
