// SPDX-License-Identifier: Apache-2.0
#include "simulate/flow_fields.h"

#include <cmath>

namespace sg {

namespace {

Box3 box_to(Vec3 hi) {
  Box3 b;
  b.add(Vec3());
  b.add(hi);
  return b;
}

DatasetPtr at_time(UniformGrid g, FieldSet fields, double time) {
  DatasetParts parts;
  parts.mesh = std::move(g);
  parts.fields = std::move(fields);
  parts.time = time;
  return make_dataset(std::move(parts));
}

}  // namespace

void describe(Schema& s, AbcParams& p) {
  describe_grid(s, p.grid);
  s("a", p.a, "Strength of the waves along z.");
  s("b", p.b, "Strength of the waves along x.");
  s("c", p.c, "Strength of the waves along y.");
}
DatasetPtr abc(const AbcParams& p, Context& context) {
  const UniformGrid g = analytic_grid(p.grid, box_to(Vec3(1, 1, 1) * (2 * M_PI)), "abc", context);
  FieldSet fields;
  fields.add(analytic_field(g, p.grid, "velocity", 3, "", Role::vectors, context, [&](Vec3 x, double* v) {
    v[0] = p.a * std::sin(x.z) + p.c * std::cos(x.y);
    v[1] = p.b * std::sin(x.x) + p.a * std::cos(x.z);
    v[2] = p.c * std::sin(x.y) + p.b * std::cos(x.x);
  }));
  return make_dataset(g, std::move(fields));
}

void describe(Schema& s, DoubleGyreParams& p) {
  describe_grid(s, p.grid);
  s("amplitude", p.amplitude, "Strength of the gyres (A).");
  s("epsilon", p.epsilon, "Amplitude of the middle line's swing.");
  s("period", p.period, "Period of the swing.").positive();
  s("time", p.time, "Time to compute.");
}
Vec3 double_gyre_velocity(const DoubleGyreParams& p, Vec3 x, double time) {
  const double swing = p.epsilon * std::sin(2 * M_PI * time / p.period);
  const double f = swing * x.x * x.x + (1 - 2 * swing) * x.x, slope = 2 * swing * x.x + 1 - 2 * swing;
  return {-M_PI * p.amplitude * std::sin(M_PI * f) * std::cos(M_PI * x.y),
          M_PI * p.amplitude * std::cos(M_PI * f) * std::sin(M_PI * x.y) * slope, 0};
}
DatasetPtr double_gyre(const DoubleGyreParams& p, Context& context) {
  const UniformGrid g = analytic_grid(p.grid, box_to({2, 1, 0}), "double_gyre", context);
  const double swing = p.epsilon * std::sin(2 * M_PI * p.time / p.period);
  FieldSet fields;
  fields.add(analytic_field(g, p.grid, "velocity", 3, "", Role::vectors, context, [&](Vec3 x, double* v) {
    const Vec3 u = double_gyre_velocity(p, x, p.time);
    v[0] = u.x, v[1] = u.y, v[2] = u.z;
  }));
  fields.add(analytic_field(g, p.grid, "stream function", 1, "", Role::none, context, [&](Vec3 x, double* v) {
    *v = p.amplitude * std::sin(M_PI * (swing * x.x * x.x + (1 - 2 * swing) * x.x)) * std::sin(M_PI * x.y);
  }));
  return at_time(g, std::move(fields), p.time);
}

void describe(Schema& s, TaylorGreenParams& p) {
  describe_grid(s, p.grid);
  s("viscosity", p.viscosity, "Kinematic viscosity.").at_least(0);
  s("time", p.time, "Time to compute.");
}
DatasetPtr taylor_green(const TaylorGreenParams& p, Context& context) {
  const UniformGrid g = analytic_grid(p.grid, box_to({2 * M_PI, 2 * M_PI, 0}), "taylor_green", context);
  const double u = std::exp(-2 * p.viscosity * p.time);
  FieldSet fields;
  fields.add(analytic_field(g, p.grid, "velocity", 3, "", Role::vectors, context, [&](Vec3 x, double* v) {
    v[0] = u * std::cos(x.x) * std::sin(x.y);
    v[1] = -u * std::sin(x.x) * std::cos(x.y);
    v[2] = 0;
  }));
  fields.add(analytic_field(g, p.grid, "pressure", 1, "", Role::none, context,
                            [&](Vec3 x, double* v) { *v = -u * u * (std::cos(2 * x.x) + std::cos(2 * x.y)) / 4; }));
  return at_time(g, std::move(fields), p.time);
}

}  // namespace sg
