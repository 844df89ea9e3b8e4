// SPDX-License-Identifier: Apache-2.0
// Volumes whose values or lengths are far from 1, as densities in SI units or galaxies in centimetres are, drawn in other units: rays
// compute in floats, whose squares and cubes must stay finite and nonzero.
#pragma once
#include <optional>

#include "render/composite/fragments.h"
#include "scene/scene.h"

namespace sg::volume {

/// A scene in units in which values and lengths are near 1. Factors are powers of two, so that nothing is rounded, and a scene scaled by
/// powers of two gives the same picture, byte for byte.
struct NaturalScene {
  Scene scene;
  double length = 1;  ///< of a world length in these units

  Projection projection(const Projection& world) const;
  FragmentLists fragments(FragmentLists world) const;
};

/// Nothing when all volumes have values (the largest that colours and opacity tell apart, between 2^-20 and 2^30), lengths (diagonal
/// between 2^-20 and 2^20) and slopes near 1. Else each volume has a copy of its field, kept with its dataset, unless a field of integers
/// needs none, and of its points. Opaque surfaces come along where they may cast shadows. Throws Error(usage) for items that are
/// not volumes.
std::optional<NaturalScene> natural_scene(const Scene& scene);

}  // namespace sg::volume
