// SPDX-License-Identifier: Apache-2.0
// What the integral of one medium (integrate.cpp) and of several at once (joint.cpp) share where media depend on more than the value.
#pragma once
#include "render/volume/rays/integrate.h"

namespace sg::volume {

/// A sample of such a medium, lit.
struct Place : DetailPlace {
  Vec3f glow;  ///< tau times colour
};
Place place_at(const Look& look, const Stretch& stretch, double t, RayField& walker);

}  // namespace sg::volume
