// SPDX-License-Identifier: Apache-2.0
#include "simulate/drift.h"

#include <algorithm>
#include <cmath>

#include "support/test.h"

using namespace sg;

TEST_CASE("drift: the tracer is carried with the stated speed: df/dt + u df/dx = 0") {
  const DriftParams p;
  const double h = 1e-4;
  double most = 0;
  for (const Vec3 at : {Vec3{10, 3, 29.8}, Vec3{200, -45, 20}, Vec3{359, 60, 4}, Vec3{77, 20, 30}})
    for (const double t : {0.0, 3.3, 20.0}) {
      const double by_time = (drift_tracer(p, at, t + h) - drift_tracer(p, at, t - h)) / (2 * h);
      const double by_x = (drift_tracer(p, at + Vec3{h, 0, 0}, t) - drift_tracer(p, at - Vec3{h, 0, 0}, t)) / (2 * h);
      CHECK(by_time + drift_speed(p, at) * by_x == doctest::Approx(0).scale(1).epsilon(1e-6));
      most = std::max(most, std::abs(by_time));
    }
  CHECK(most > 0.1);
}

TEST_CASE("drift: the grid holds the tracer at its time, and it comes round after 360 degrees") {
  DriftParams p;
  p.grid.dims = {370, 9, 5}, p.time = 2.5;
  Context context;
  const DatasetPtr d = drift(p, context);
  const UniformGrid& g = *d->as<UniformGrid>();
  const auto v = d->fields().require("tracer").array.view<float>();
  CHECK(d->time() == 2.5);
  for (const std::array<size_t, 3> i : {std::array<size_t, 3>{0, 0, 0}, std::array<size_t, 3>{20, 4, 2}, std::array<size_t, 3>{369, 8, 4}})
    CHECK(v[i[0] + 370 * (i[1] + 9 * i[2])] ==
          doctest::Approx(drift_tracer(p, g.origin + g.spacing * Vec3(double(i[0]), double(i[1]), double(i[2])), 2.5))
              .scale(1)
              .epsilon(1e-7));
  CHECK(v[370 * 4] == doctest::Approx(v[369 + 370 * 4]).epsilon(1e-6));
}
