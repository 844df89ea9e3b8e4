// SPDX-License-Identifier: Apache-2.0
// Analytic flows on a uniform grid.
#pragma once
#include "simulate/analytic_grid.h"

namespace sg {

/// Arnold-Beltrami-Childress flow u = (a sin z + c cos y, b sin x + a cos z, c sin y + b cos x) on [0,2pi]^3: div u = 0, curl u = u,
/// mean of |u|^2 = a^2+b^2+c^2 (Dombre et al. 1986).
struct AbcParams {
  GridParams grid;
  double a = 1.7320508075688772, b = 1.4142135623730951, c = 1;  ///< sqrt 3, sqrt 2, 1
};
void describe(Schema& s, AbcParams& p);
DatasetPtr abc(const AbcParams& p, Context& context);

/// Double gyre of Shadden, Lekien, Marsden 2005 on [0,2]x[0,1] at one time: u = -pi A sin(pi f) cos(pi y),
/// v = pi A cos(pi f) sin(pi y) df/dx, f = eps sin(w t) x^2 + (1 - 2 eps sin(w t)) x. Fields "velocity" (w = 0) and "stream function".
struct DoubleGyreParams {
  GridParams grid{.size = 129, .dims = {}, .bounds = {}, .type = FieldType::f32};
  double amplitude = 0.1, epsilon = 0.25, period = 10, time = 0;
};
void describe(Schema& s, DoubleGyreParams& p);
DatasetPtr double_gyre(const DoubleGyreParams& p, Context& context);
/// Velocity at a point.
Vec3 double_gyre_velocity(const DoubleGyreParams& p, Vec3 position, double time);

/// Taylor-Green vortices u = U(cos x sin y, -sin x cos y, 0), decaying as exp(-2 viscosity t), an exact solution of the Navier-Stokes
/// equations with density 1 and p = -U^2 (cos 2x + cos 2y)/4, on [0,2pi]^2 (any z range by `bounds`).
struct TaylorGreenParams {
  GridParams grid{.size = 65, .dims = {}, .bounds = {}, .type = FieldType::f32};
  double viscosity = 0.1, time = 0;
};
void describe(Schema& s, TaylorGreenParams& p);
DatasetPtr taylor_green(const TaylorGreenParams& p, Context& context);

}  // namespace sg
