// SPDX-License-Identifier: Apache-2.0
// Collision: where a path turns or ends in a medium.
#pragma once
#include <cstdint>

#include "base/vec.h"
#include "render/shade/phase_function.h"

namespace sg::trace {

struct Collision {
  float t = 0;        ///< along the ray, traced
  uint32_t item = 0;  ///< number in the scene
  Vec3f albedo;       ///< share of the light that is scattered
  Vec3f emission;     ///< radiance that the place adds to the light, by all of the extinction
  PhaseFunction phase;
  bool last = false;  ///< light is scattered once only
  /// A surface rather than matter: what is opaque within a cell and has a gradient reflects light as a diffuse surface.
  bool on_surface = false;
  Vec3f normal;     ///< of that surface, unit, towards where the ray came from
  float clear = 0;  ///< traced length along the normal from which on it no longer hides itself

  /// Where rays start that go on from a place `at` that was met: clear of the surface.
  Vec3f start(Vec3f at) const { return on_surface ? at + normal * clear : at; }
  /// Of light that is scattered, the share per solid angle that joins the ways `along` (the ray's) and `direction`, both unit; and the
  /// density with which sample() draws that direction.
  float density(Vec3f along, Vec3f direction) const;
  /// A direction drawn by density(), unit; u uniform in the unit square.
  Vec3f sample(Vec3f along, Vec2f u) const;
};

}  // namespace sg::trace
