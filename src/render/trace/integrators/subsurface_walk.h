// SPDX-License-Identifier: Apache-2.0
// Light that enters a body and wanders below its surface until it comes out somewhere else.
#pragma once
#include <optional>

#include "render/trace/integrators/world.h"
#include "render/trace/sampling/random_stream.h"

namespace sg::trace {

/// Where it comes out, on the outer side of `at`, and with what weight: without Bsdf::entering() there and Bsdf::leaving() here.
struct WalkExit {
  Vertex at;
  Vec3f weight;
};

/// A random walk through matter of the mean free paths of the entry's material, which scatters so much that a half-space has the colour of
/// the entry. Free paths are drawn by one of the channels and weighed by the mean of all their densities (Wrenninge, Villemin, Hery 2017).
/// Surfaces of other items in the body reflect; an open surface has matter without end behind it. Nothing where the light is absorbed.
std::optional<WalkExit> walk_below(const World& world, const Vertex& entry, RandomStream& random);

}  // namespace sg::trace
