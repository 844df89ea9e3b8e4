// SPDX-License-Identifier: Apache-2.0
#include "simulate/scalar_fields.h"

#include <fmt/core.h>

#include <cmath>

namespace sg {

namespace {

Box3 around(Vec3 c, double r) {
  Box3 b;
  b.add(c - Vec3(r, r, r));
  b.add(c + Vec3(r, r, r));
  return b;
}

template <class F>
DatasetPtr scalar_source(const GridParams& grid, const Box3& own, const char* source, const char* field, const char* unit,
                         const Context& context, F&& f) {
  const UniformGrid g = analytic_grid(grid, own, source, context);
  FieldSet fields;
  fields.add(analytic_field(g, grid, field, 1, unit, Role::scalars, context, [&](Vec3 p, double* v) { *v = f(p); }));
  return make_dataset(g, std::move(fields));
}

}  // namespace

void describe(Schema& s, MarschnerLobbParams& p) {
  describe_grid(s, p.grid);
  s("frequency", p.frequency, "Number of waves across the signal (f_M).").positive();
  s("alpha", p.alpha, "Amplitude of the waves relative to the slope along z.").positive();
}
DatasetPtr marschner_lobb(const MarschnerLobbParams& p, Context& context) {
  return scalar_source(p.grid, around({}, 1), "marschner_lobb", "density", "", context, [&](Vec3 x) {
    const double rho = std::cos(2 * M_PI * p.frequency * std::cos(M_PI * std::hypot(x.x, x.y) / 2));
    return (1 - std::sin(M_PI * x.z / 2) + p.alpha * (1 + rho)) / (2 * (1 + p.alpha));
  });
}

void describe(Schema& s, TangleParams& p) {
  describe_grid(s, p.grid);
  s("constant", p.constant, "Constant added to the function.");
}
DatasetPtr tangle(const TangleParams& p, Context& context) {
  return scalar_source(p.grid, around({}, 3), "tangle", "tangle", "", context, [&](Vec3 x) {
    auto q = [](double t) { return t * t * (t * t - 5); };
    return q(x.x) + q(x.y) + q(x.z) + p.constant;
  });
}

void describe(Schema& s, GyroidParams& p) {
  describe_grid(s, p.grid);
  s("period", p.period, "Length of one period.").positive();
}
DatasetPtr gyroid(const GyroidParams& p, Context& context) {
  return scalar_source(p.grid, around({}, p.period), "gyroid", "gyroid", "", context, [k = 2 * M_PI / p.period](Vec3 x) {
    const double sx = std::sin(k * x.x), cx = std::cos(k * x.x), sy = std::sin(k * x.y), cy = std::cos(k * x.y), sz = std::sin(k * x.z),
                 cz = std::cos(k * x.z);
    return sx * cy + sy * cz + sz * cx;
  });
}

void describe(Schema& s, SphereParams& p) {
  describe_grid(s, p.grid);
  s("center", p.center, "Centre of the sphere.");
  s("radius", p.radius, "Radius of the sphere.").positive();
}
DatasetPtr sphere(const SphereParams& p, Context& context) {
  return scalar_source(p.grid, around(p.center, 1.3 * p.radius), "sphere", "distance", "", context,
                       [&](Vec3 x) { return length(x - p.center) - p.radius; });
}

void describe(Schema& s, TorusParams& p) {
  describe_grid(s, p.grid);
  s("center", p.center, "Centre of the torus.");
  s("major_radius", p.major_radius, "Distance from the centre to the middle of the tube.").positive();
  s("minor_radius", p.minor_radius, "Radius of the tube.").positive();
}
DatasetPtr torus(const TorusParams& p, Context& context) {
  return scalar_source(p.grid, around(p.center, p.major_radius + 1.5 * p.minor_radius), "torus", "distance", "", context, [&](Vec3 x) {
    const Vec3 d = x - p.center;
    return std::hypot(std::hypot(d.x, d.y) - p.major_radius, d.z) - p.minor_radius;
  });
}

void describe(Schema& s, HydrogenParams& p) {
  describe_grid(s, p.grid);
  s("n", p.n, "Principal quantum number.").range(1, 12);
  s("l", p.l, "Angular momentum, below n.").range(0, 11);
  s("m", p.m, "Magnetic quantum number, from -l to l; its sign selects sine or cosine.").range(-11, 11);
}

double hydrogen_orbital(int n, int l, int m, Vec3 p) {
  const double r = length(p), rho = 2 * r / n;
  // Associated Laguerre L_{n-l-1}^{2l+1}(rho) and Legendre P_l^|m|(cos theta) by their recurrences.
  const int degree = n - l - 1;
  const double a = 2 * l + 1;
  double before = 0, laguerre = 1;
  for (int k = 0; k < degree; ++k) {
    const double next = ((2 * k + 1 + a - rho) * laguerre - (k + a) * before) / (k + 1);
    before = laguerre, laguerre = next;
  }
  const int order = std::abs(m);
  const double c = r > 0 ? p.z / r : 1, s = r > 0 ? std::hypot(p.x, p.y) / r : 0;
  double legendre = 1, below = 0;
  for (int k = 1; k <= order; ++k) legendre *= (2 * k - 1) * s;  // without the sign (-1)^m
  for (int k = order; k < l; ++k) {
    const double next = ((2 * k + 1) * c * legendre - (k + order) * below) / (k - order + 1);
    below = legendre, legendre = next;
  }
  // Norms; a ratio of factorials as a product.
  auto ratio = [](int top, int bottom) {
    double x = 1;
    for (int k = bottom + 1; k <= top; ++k) x *= k;
    return x;
  };
  const double radial = std::sqrt(8.0 / (double(n) * n * n) / (2.0 * n * ratio(n + l, n - l - 1)));
  const double angular = std::sqrt((2 * l + 1) / (4 * M_PI) / ratio(l + order, l - order) * (order ? 2 : 1));
  const double azimuth = order == 0 ? 1 : m > 0 ? std::cos(order * std::atan2(p.y, p.x)) : std::sin(order * std::atan2(p.y, p.x));
  return radial * std::exp(-rho / 2) * std::pow(rho, l) * laguerre * angular * legendre * azimuth;
}

DatasetPtr hydrogen(const HydrogenParams& p, Context& context) {
  if (p.n < 1 || p.l < 0 || p.l >= p.n || std::abs(p.m) > p.l)
    fail_usage(fmt::format("there is no orbital n={} l={} m={}", p.n, p.l, p.m), "hydrogen", "l must be in 0..n-1 and m in -l..l");
  const UniformGrid g = analytic_grid(p.grid, around({}, p.n * (1.5 * p.n + 5)), "hydrogen", context);
  FieldSet fields;
  fields.add(analytic_field(g, p.grid, "probability density", 1, "1/a0^3", Role::scalars, context, [&](Vec3 x, double* v) {
    const double psi = hydrogen_orbital(p.n, p.l, p.m, x);
    *v = psi * psi;
  }));
  fields.add(analytic_field(g, p.grid, "wave function", 1, "1/a0^1.5", Role::none, context,
                            [&](Vec3 x, double* v) { *v = hydrogen_orbital(p.n, p.l, p.m, x); }));
  return make_dataset(g, std::move(fields));
}

}  // namespace sg
