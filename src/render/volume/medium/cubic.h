// SPDX-License-Identifier: Apache-2.0
// Cubics by their Bernstein coefficients: values, turns, and where they pass a level.
#pragma once
#include "render/volume/medium/stretch.h"

namespace sg::volume {

/// Places f in [0,1], ascending, at which the cubic with Bernstein coefficients b passes `level`; a cubic that equals the level everywhere
/// has none. Touching counts once. Returns their number (at most 3).
int crossings(const float b[4], float level, double f[3]);
/// The places in (0,1) where the derivative is zero, ascending (at most 2).
int turns(const float b[4], double f[2]);
/// Value of the cubic, in double.
double bernstein(const float b[4], double f);
/// The part of a stretch between two places.
Stretch part_of(const Stretch& stretch, double from, double to);

}  // namespace sg::volume
