// SPDX-License-Identifier: Apache-2.0
// Velocities from particles to the faces of a staggered grid, and back.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "base/schema/enum_words.h"
#include "simulate/fluid/particle_grid.h"

namespace sg::fluid {

/// How particles take the velocity of the grid (after Jiang, Schroeder, Selle, Teran, Stomakhin 2015).
enum class Transfer {
  pic,   ///< what the grid has there: smooths (Harlow 1964)
  flip,  ///< their own and the change of the grid's (Brackbill, Ruppel 1986), a share of it (Zhu, Bridson 2005)
  apic,  ///< what the grid has there, and how it varies about them: keeps turning motion
};
constexpr auto enum_words(Transfer) {
  using enum Transfer;
  return std::array{Word{"pic", pic}, Word{"flip", flip}, Word{"apic", apic}};
}

struct Particle3 {
  Vec3 x;                 ///< from the grid's origin, in units of h
  Vec3 v;                 ///< length per time
  std::array<Vec3, 3> c;  ///< gradients of the components of v, per h; of apic alone
};

/// u = the mean velocity of the particles about each face, weighted by linear interpolation; 0, and `weight` 0, where there are none. The
/// particles are sorted by cell. The same for any number of threads.
void particles_to_faces(const MacGrid& g, const std::vector<Particle3>& particles, const std::vector<uint32_t>& begin, Faces<double>& u,
                        Faces<double>& weight, const Context& context);

/// The velocity at x, in units of h from the origin, and with `c` its gradients.
Vec3 velocity_at(const MacGrid& g, const Faces<double>& u, const Vec3& x, std::array<Vec3, 3>* c = nullptr);

/// Gives faces whose `known` is 0 the mean of their known neighbours, so many layers far.
void extrapolate(const MacGrid& g, Faces<double>& u, Faces<double>& known, int layers, const Context& context);

}  // namespace sg::fluid
