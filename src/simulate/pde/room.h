// SPDX-License-Identifier: Apache-2.0
// The uniform grid of a partial differential equation: where its unknowns lie between the sides of a box.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/mesh.h"
#include "simulate/analytic_grid.h"
#include "simulate/fluid/mac_grid.h"
#include "simulate/pde/sides.h"

namespace sg::pde {

/// One number an unknown, x fastest.
using Values = fluid::Lattice<double>;

struct RoomParams {
  int size = 64;
  std::vector<double> bounds;
  FieldType type = FieldType::f32;
  std::string sides = "insulated";
  std::string x0, x1, y0, y1, z0, z1;
};
void describe(Schema& s, RoomParams& p);

/// The unknowns along one axis. A side with values lies one spacing away from the nearest of them, an insulated or periodic one half a
/// spacing: with that, every stencil is second, minus first, over h^2 of its neighbours, and exact in its eigenvalues:
/// both held, h = L/(n+1): -(4/h^2) sin^2(k pi/(2(n+1))); both insulated, h = L/n: -(4/h^2) sin^2(k pi/(2n));
/// one of each, h = L/(n+1/2): -(4/h^2) sin^2((2k-1) pi/(2(2n+1))); periodic, h = L/n, n even: -(4/h^2) sin^2(k pi/n).
struct Axis {
  size_t n = 1;
  double length = 0;  ///< 0: no extent, one place, no neighbours
  Side lo, hi;

  bool flat() const { return length == 0; }
  double h() const;
  double first() const;  ///< of the first unknown, from the lower side on
  double coupling() const { return flat() ? 0 : 1 / (h() * h()); }
  /// The least eigenvalue of minus the second difference that is not 0.
  double least_eigenvalue() const;
};

struct Room {
  std::array<Axis, 3> axes;
  Vec3 corner;  ///< of the box

  std::array<size_t, 3> n() const { return {axes[0].n, axes[1].n, axes[2].n}; }
  size_t count() const { return axes[0].n * axes[1].n * axes[2].n; }
  /// Sum of 1/h^2 over the axes: an explicit step of heat is stable up to 1 / (2 kappa times that).
  double couplings() const { return axes[0].coupling() + axes[1].coupling() + axes[2].coupling(); }
  double smallest_h() const;
  /// Some side has values.
  bool held() const;
  /// The unknowns as points.
  UniformGrid grid() const;
  Sides sides() const { return {axes[0].lo, axes[0].hi, axes[1].lo, axes[1].hi, axes[2].lo, axes[2].hi}; }
};

/// Throws Error(usage) for boxes without extent, periodic sides without their opposite, absorbing ones unless `waves`, and for more
/// unknowns than memory could hold at `bytes` each.
Room make_room(const RoomParams& p, const std::string& who, double bytes, bool waves, const Context& context);

}  // namespace sg::pde
