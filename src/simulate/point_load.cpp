// SPDX-License-Identifier: Apache-2.0
#include "simulate/point_load.h"

#include <algorithm>
#include <cmath>

namespace sg {

void describe(Schema& s, PointLoadParams& p) {
  describe_grid(s, p.grid);
  s("load", p.load, "Force along +z.");
  s("poisson", p.poisson, "Poisson's ratio.").range(0, 0.5);
}

void point_load_stress(double load, double nu, Vec3 p, double* s) {
  const double x = p.x, y = p.y, z = p.z, R = length(p);
  if (!(R > 0) || z < 0) {
    std::fill(s, s + 9, NAN);
    return;
  }
  // Written with R+z in place of x^2+y^2 below the line, so that nothing is 0/0 on the axis.
  const double R3 = R * R * R, R5 = R3 * R * R, k = load / (2 * M_PI), e = 1 - 2 * nu, c = 1 / (R * (R + z)),
               d = (2 * R + z) / (R3 * (R + z) * (R + z));
  const double xx = -3 * x * x * z / R5 + e * (z / R3 - c + x * x * d);
  const double yy = -3 * y * y * z / R5 + e * (z / R3 - c + y * y * d);
  const double zz = -3 * z * z * z / R5;
  const double xy = -3 * x * y * z / R5 + e * x * y * d;
  const double xz = -3 * x * z * z / R5, yz = -3 * y * z * z / R5;
  const double all[9] = {xx, xy, xz, xy, yy, yz, xz, yz, zz};
  for (int i = 0; i < 9; ++i) s[i] = k * all[i];
}

DatasetPtr point_load(const PointLoadParams& p, Context& context) {
  Box3 own;
  own.add(Vec3(-1, -1, 0.1));  // the stress is infinite at the load itself
  own.add(Vec3(1, 1, 2.1));
  const UniformGrid g = analytic_grid(p.grid, own, "point_load", context);
  FieldSet fields;
  fields.add(analytic_field(g, p.grid, "stress", 9, "", Role::tensors, context,
                            [&](Vec3 x, double* v) { point_load_stress(p.load, p.poisson, x, v); }));
  fields.add(analytic_field(g, p.grid, "von Mises stress", 1, "", Role::none, context, [&](Vec3 x, double* v) {
    double s[9];
    point_load_stress(p.load, p.poisson, x, s);
    const double a = s[0] - s[4], b = s[4] - s[8], c = s[8] - s[0];
    *v = std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[1] * s[1] + s[2] * s[2] + s[5] * s[5]));
  }));
  return make_dataset(g, std::move(fields));
}

}  // namespace sg
