// SPDX-License-Identifier: Apache-2.0
// What path, streak and time surfaces share: the run over a curve of seeds, and points as they are collected. Internal to filter/flow.
#pragma once
#include <fmt/core.h>

#include <algorithm>

#include "filter/flow/fronts/unsteady_surfaces.h"

namespace sg {

UnsteadyParams run_params(const UnsteadySurfaceParams& p, const std::vector<Vec3>& seeds);
/// Diagonal of the box of the series' first step.
double first_diagonal(const Series& series);

/// Points of a surface and its triangles.
struct Collected {
  std::vector<Vec3> x, v;
  std::vector<double> time, s, born;
  std::vector<int64_t> triangles;

  /// The number of the new point.
  int64_t add(const Particle& p, double seed_parameter, double release) {
    x.push_back(p.x), v.push_back(p.v), time.push_back(p.t), s.push_back(seed_parameter), born.push_back(release);
    return int64_t(x.size() - 1);
  }
};
/// With the fields of unsteady_surfaces.h, as data of the time `end`; `releases`: with "release time".
DatasetPtr surface_dataset(Collected c, const Field& velocity, double start, double end, bool releases);

/// A run over a curve, with evenly spaced seeds at most `spacing` apart.
struct CurveRun {
  SeedCurve curve;
  double spacing;
  std::vector<double> parameters;  ///< of the seeds
  UnsteadyRun run;

  CurveRun(const Series& series, const std::vector<Data>& others, const UnsteadySurfaceParams& p, const SeedCurveParams& c, const char* who,
           Context& context);

 private:
  std::vector<Vec3> places() const;
};

/// The run's intervals in parts, in which the fastest place goes at most `spacing`: opens each interval and calls f(t) at the ends of its
/// parts. `points()`: how many the surface has, checked against `most` before each.
template <class Count, class F>
void each_part(UnsteadyRun& run, double spacing, int64_t most, const char* who, Count&& points, F&& f) {
  double now = run.start;
  run.each_interval([&](double until) {
    const double far = run.flow.largest_speed() * (until - now);
    const auto n = size_t(std::clamp(std::ceil(far / spacing), 1.0, 10000.0));
    for (size_t k = 1; k <= n; ++k) {
      if (int64_t(points()) > most)
        fail_usage(fmt::format("the surface has more than {} points", most), who, "use a larger spacing or max_points");
      f(k == n ? until : now + (until - now) * double(k) / double(n));
    }
    now = until;
  });
}

}  // namespace sg
