// SPDX-License-Identifier: Apache-2.0
#include "simulate/drift.h"

#include <cmath>

namespace sg {

namespace {
constexpr double degree = 0.017453292519943295;
}

void describe(Schema& s, DriftParams& p) {
  describe_grid(s, p.grid);
  s("speed", p.speed, "Speed of the jet at the equator and the surface, degrees per time.");
  s("time", p.time, "When.");
}

double drift_speed(const DriftParams& p, Vec3 at) { return p.speed * std::cos(3 * at.y * degree) * std::exp(-0.5 * at.z); }

double drift_tracer(const DriftParams& p, Vec3 at, double time) {
  const double y = at.y * degree, x = (at.x - drift_speed(p, at) * time) * degree, c = std::cos(y);
  return std::exp(-0.5 * at.z) *
         (0.5 * std::cos(4 * x) * std::cos(3 * y) + c * c * (0.3 * std::cos(9 * x + 5 * y) + 0.2 * std::cos(17 * x - 8 * y)));
}

DatasetPtr drift(const DriftParams& p, Context& context) {
  const UniformGrid grid = analytic_grid(p.grid, {{0, -80, 0}, {360, 80, 5}}, "drift", context);
  DatasetParts parts;
  parts.mesh = grid;
  parts.time = p.time;
  parts.fields.add(analytic_field(grid, p.grid, "tracer", 1, "", Role::scalars, context,
                                  [&](Vec3 at, double* out) { out[0] = drift_tracer(p, at, p.time); }));
  return make_dataset(std::move(parts));
}

}  // namespace sg
