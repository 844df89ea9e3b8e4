// SPDX-License-Identifier: Apache-2.0
// Turn: how the vertex at the end of a half goes on into a direction, in which it is joined with something.
#pragma once
#include <optional>

#include "render/trace/integrators/bidirectional/subpath.h"

namespace sg::trace {

struct Turn {
  Vec3f scattered;      ///< f |cos|; in a medium albedo * phase function
  double onward = 0;    ///< density of the direction, per solid angle
  double backward = 0;  ///< that of the one to its parent, from there
};

/// Nothing where no light goes that way. `transport`: radiance at the end of the camera's half, importance at that of the light's.
std::optional<Turn> turn(const PathVertex& v, Vec3f direction, Transport transport);

}  // namespace sg::trace
