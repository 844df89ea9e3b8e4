// SPDX-License-Identifier: Apache-2.0
// What the integral of one medium (integrate.cpp) and of several at once (joint.cpp) share where media hang on more than the value.
#pragma once
#include "render/volume/rays/integrate.h"

namespace sg::volume {

/// May these places, such a length apart from the first to the last, have missed something that is drawn between them?
bool overlooks(const Detail& detail, double length, const DetailPlace& a, const DetailPlace& m, const DetailPlace& b);

/// A place of such a medium, lit.
struct Place : DetailPlace {
  Vec3f glow;  ///< tau times colour
};
Place place_at(const Look& look, const Stretch& stretch, double t, RayField& walker);

}  // namespace sg::volume
