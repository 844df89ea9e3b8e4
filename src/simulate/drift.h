// SPDX-License-Identifier: Apache-2.0
// A tracer carried by jets: a time series of any size whose every value is known.
#pragma once
#include "simulate/analytic_grid.h"

namespace sg {

/// Waves of a tracer on longitude 0..360, latitude -80..80 (degrees) and height 0..30, carried along circles of latitude with the speed
/// u(y, z) = speed cos(3y) exp((z - 30)/12) degrees per time: f(x, y, z, t) = f0(x - u t, y, z), so df/dt + u df/dx = 0 exactly while the
/// shear winds the waves up. f0 = exp((z - 30)/12) (0.5 cos 4x cos 3y + 0.3 cos(9x + 5y) cos^2 y + 0.2 cos(17x - 8y) cos^2 y).
struct DriftParams {
  GridParams grid{.size = 181, .dims = {}, .bounds = {}, .type = FieldType::f32};
  double speed = 12, time = 0;
};
void describe(Schema& s, DriftParams& p);
/// Point field "tracer". 2160 x 960 x 30 points are 249 MB a step as f32.
DatasetPtr drift(const DriftParams& p, Context& context);
/// Its value and speed at a place.
double drift_tracer(const DriftParams& p, Vec3 place, double time);
double drift_speed(const DriftParams& p, Vec3 place);

}  // namespace sg
