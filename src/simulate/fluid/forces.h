// SPDX-License-Identifier: Apache-2.0
// What moves the air: buoyancy, vortices that are given back what the grid took from them, friction.
#pragma once
#include "base/context.h"
#include "simulate/fluid/walls/sides.h"
#include "simulate/fluid/walls/walls.h"

namespace sg::fluid {

/// u += dt (lift temperature - weight density) up (Fedkiw, Stam, Jensen 2001, equation 8), with both in the middle of the faces as the mean
/// of the cells beside them. On open sides of the box it is that of the cell inside; on closed ones there is nothing to move.
template <class T>
void add_buoyancy(const MacGrid& g, const OpenSides& open, const Lattice<T>& density, const Lattice<T>& temperature, Vec3 up, double weight,
                  double lift, double dt, Faces<T>& u, const Context& context);

/// Vorticity confinement, u += dt strength h (N x w) with N = grad |w| / |grad |w|| (Steinhoff, Underhill 1994; Fedkiw, Stam, Jensen 2001,
/// equation 11). `spare`: four lattices.
template <class T>
void confine_vortices(const MacGrid& g, double strength, double dt, Faces<T>& u, Spare<T> spare, const Context& context);

/// One implicit step of du/dt = viscosity lap u for each component by itself, (I - dt viscosity lap) u = u before: stable at any dt.
/// Sides hold what flows along them, or let it slip; faces
/// whose middle is solid have the velocity of the solid and hold what flows beside them. By
/// conjugate gradients, to 1e-6 of the largest value (1e-12 in double precision). `spare`: three lattices.
template <class T>
void diffuse_velocity(const MacGrid& g, const Walls<T>& walls, const Sides& sides, double viscosity, double dt, Faces<T>& u, Spare<T> spare,
                      const Context& context);

}  // namespace sg::fluid
