// SPDX-License-Identifier: Apache-2.0
// Msh, polar CIELAB, in which diverging maps run [Moreland, Diverging Color Maps for Scientific Visualization, 2009].
#pragma once
#include "base/vec.h"

namespace sg {

struct Msh {
  double m;  ///< magnitude: distance from black
  double s;  ///< saturation: angle from the axis of greys
  double h;  ///< hue: angle around it
};

Msh lab_to_msh(Vec3 lab);
Vec3 msh_to_lab(Msh c);

/// The hue that a grey of magnitude `m` takes so that the path to a saturated colour does not bend (AdjustHue in the paper).
double adjusted_hue(Msh saturated, double m);

}  // namespace sg
