// SPDX-License-Identifier: Apache-2.0
// The stress under a point load on an elastic half space.
#pragma once
#include "simulate/analytic_grid.h"

namespace sg {

/// Boussinesq's solution (1885; Timoshenko and Goodier, Theory of Elasticity, art. 138): a force P at the origin presses along +z into
/// the half space z >= 0. Tension is positive; on the axis s_zz = -3P/(2 pi z^2) and s_xx = s_yy = (1-2 nu) P/(4 pi z^2).
/// Fields: "stress" (9 components, rows xx xy xz ...), "von Mises stress", both in units of force per length^2. NaN at the origin and above
/// the surface (z < 0), where there is no material.
struct PointLoadParams {
  GridParams grid{.size = 41, .dims = {}, .bounds = {}, .type = FieldType::f32};
  double load = 1;
  double poisson = 0.25;
};
void describe(Schema& s, PointLoadParams& p);
DatasetPtr point_load(const PointLoadParams& p, Context& context);
/// Fills xx xy xz yx yy yz zx zy zz.
void point_load_stress(double load, double poisson, Vec3 position, double* stress);

}  // namespace sg
