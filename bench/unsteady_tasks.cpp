// SPDX-License-Identifier: Apache-2.0
// Particles in an ABC flow whose strength swings: 21 time steps of 64^3 in memory, 10,000 seeds, released again at each step (streaklines,
// particles) or once (pathlines), as the peers' filters do: RK4, one step an
// interval; and with the error control that is our default.
#include <fmt/core.h>

#include <numbers>

#include "base/parallel.h"
#include "bench.h"
#include "filter/flow/unsteady/pathlines.h"
#include "filter/flow/unsteady/streaklines.h"

namespace sg::bench {

namespace {

constexpr size_t n = 64, intervals = 20, seed_count = 10000;

Series swinging_flow() {
  const double a = std::sqrt(3.0), b = std::sqrt(2.0);
  std::vector<double> s(n), c(n);
  for (size_t i = 0; i < n; ++i) {
    const double x = std::numbers::pi * (2 * double(i) / double(n - 1));
    s[i] = std::sin(x), c[i] = std::cos(x);
  }
  UniformGrid g;
  g.dims = {n, n, n};
  g.origin = {-1, -1, -1};
  g.spacing = Vec3(1, 1, 1) * (2.0 / double(n - 1));
  auto steps = std::make_shared<std::vector<DatasetPtr>>();
  Series series;
  for (size_t t = 0; t <= intervals; ++t) {
    const float f = float(0.6 + 0.4 * std::cos(0.3 * double(t)));
    float* v = nullptr;
    Array values = Array::make<float>(n * n * n, 3, &v);
    for (size_t k = 0; k < n; ++k)
      for (size_t j = 0; j < n; ++j)
        for (size_t i = 0; i < n; ++i, v += 3) {
          v[0] = float(a * s[k] + c[j]) * f, v[1] = float(b * s[i] + a * c[k]) * f, v[2] = float(s[j] + b * c[i]) * f;
        }
    FieldSet fields;
    fields.add({"abc", Association::point, values, "", Role::vectors});
    steps->push_back(make_dataset(g, fields));
    series.times.push_back(0.02 * double(t));
  }
  series.load = [steps](size_t k) -> Data { return (*steps)[k]; };
  return series;
}

/// Low-discrepancy points in [-0.9, 0.9]^3, those of the peers.
std::vector<Data> seeds() {
  constexpr double g = 1.22074408460575947536;
  float* x = nullptr;
  PointCloud cloud;
  cloud.points.xyz = Array::make<float>(seed_count, 3, &x);
  for (size_t i = 0; i < seed_count; ++i)
    for (int k = 0; k < 3; ++k) x[3 * i + size_t(k)] = float(1.8 * std::fmod(0.5 + double(i + 1) / std::pow(g, k + 1), 1.0) - 0.9);
  return {make_dataset(std::move(cloud))};
}

template <class Params, class Filter>
Task unsteady(const char* name, Filter filter, bool adapts) {
  Params params;
  if constexpr (std::is_same_v<Params, StreaklinesParams>) params.refine = false;  // the peer's particles, and no more
  if (!adapts) params.integration.integrator = Scheme::rk4, params.integration.step_unit = StepUnit::time, params.integration.step = 0.02;
  return {"particles_unsteady", "uniform64 x 20 time steps x 10000 seeds",
          fmt::format("sightglass:{}{}", name, adapts ? "(dormand_prince)" : ""), "points out", [=] {
            const Series series = swinging_flow();
            return [=, others = seeds()] {
              Context context;
              return double(filter(series, others, params, context)->point_count());
            };
          }};
}

}  // namespace

void add_unsteady_tasks(std::vector<Task>& tasks) {
  for (const bool adapts : {false, true}) {
    tasks.push_back(unsteady<ParticlesParams>("particles", particles, adapts));
    tasks.push_back(unsteady<StreaklinesParams>("streaklines", streaklines, adapts));
    tasks.push_back(unsteady<PathlinesParams>("pathlines", pathlines, adapts));
  }
}

}  // namespace sg::bench
