// SPDX-License-Identifier: Apache-2.0
#include "simulate/drift.h"

#include <algorithm>
#include <cmath>

namespace sg {

namespace {
constexpr double degree = 0.017453292519943295;
}

void describe(Schema& s, DriftParams& p) {
  describe_grid(s, p.grid);
  s("speed", p.speed, "Speed of the jet at the equator and the surface, in degrees per unit of time.");
  s("time", p.time, "When.");
}

double drift_speed(const DriftParams& p, Vec3 at) { return p.speed * std::cos(3 * at.y * degree) * std::exp((at.z - 30) / 12); }

double drift_tracer(const DriftParams& p, Vec3 at, double time) {
  const double y = at.y * degree, x = (at.x - drift_speed(p, at) * time) * degree, c = std::cos(y);
  return std::exp((at.z - 30) / 12) *
         (0.5 * std::cos(4 * x) * std::cos(3 * y) + c * c * (0.3 * std::cos(9 * x + 5 * y) + 0.2 * std::cos(17 * x - 8 * y)));
}

namespace {

// out[i] += amplitude * cos(at + i * step): turned on from sample to sample, begun afresh before rounding adds up.
void add_wave(double amplitude, double at, double step, double* out, size_t n) {
  const double c = std::cos(step), s = std::sin(step);
  for (size_t begin = 0; begin < n; begin += 128) {
    const double angle = at + double(begin) * step;
    double x = amplitude * std::cos(angle), y = amplitude * std::sin(angle);
    for (size_t i = begin; i < std::min(begin + 128, n); ++i) {
      out[i] += x;
      const double turned = c * x - s * y;
      y = s * x + c * y, x = turned;
    }
  }
}

template <class T>
void fill(const UniformGrid& g, const DriftParams& p, T* out, const Context& context) {
  const size_t nx = g.dims[0], ny = g.dims[1];
  parallel_for(
      ny * g.dims[2], 4,
      [&](size_t begin, size_t end) {
        std::vector<double> row(nx);
        for (size_t r = begin; r < end; ++r) {
          const Vec3 at = g.origin + g.spacing * Vec3(0, double(r % ny), double(r / ny));
          const double y = at.y * degree, x = (at.x - drift_speed(p, at) * p.time) * degree, c = std::cos(y),
                       fade = std::exp((at.z - 30) / 12);
          const double step = g.spacing.x * degree;
          std::fill(row.begin(), row.end(), 0.0);
          add_wave(0.5 * fade * std::cos(3 * y), 4 * x, 4 * step, row.data(), nx);
          add_wave(0.3 * fade * c * c, 9 * x + 5 * y, 9 * step, row.data(), nx);
          add_wave(0.2 * fade * c * c, 17 * x - 8 * y, 17 * step, row.data(), nx);
          for (size_t i = 0; i < nx; ++i) out[r * nx + i] = T(row[i]);
        }
      },
      &context);
}

}  // namespace

DatasetPtr drift(const DriftParams& p, Context& context) {
  const UniformGrid grid = analytic_grid(p.grid, {{0, -80, 0}, {360, 80, 30}}, "drift", context);
  const bool wide = p.grid.type == FieldType::f64;
  std::byte* out = nullptr;
  Array values = Array::make_raw(wide ? ElementType::f64 : ElementType::f32, grid.dims[0] * grid.dims[1] * grid.dims[2], 1, &out);
  if (wide) fill(grid, p, reinterpret_cast<double*>(out), context);
  else fill(grid, p, reinterpret_cast<float*>(out), context);
  DatasetParts parts;
  parts.mesh = grid;
  parts.time = p.time;
  parts.fields.add({"tracer", Association::point, std::move(values), "", Role::scalars});
  return make_dataset(std::move(parts));
}

}  // namespace sg
