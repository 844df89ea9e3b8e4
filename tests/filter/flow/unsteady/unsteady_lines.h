// SPDX-License-Identifier: Apache-2.0
// Flows whose particles have closed forms, and what the tests of path-, streak- and timelines look at.
#pragma once
#include <cstring>

#include "filter/flow/unsteady/unsteady_inputs.h"
#include "support/test.h"

namespace sg::test::unsteady {

// u = (U, V cos wt): stream-, path- and streaklines differ, all have closed forms.
constexpr double U = 0.4, V = 0.7, w = 2.5;
inline const auto oscillating = [](Vec3, double t) { return Vec3(U, V * std::cos(w * t), 0); };
inline Vec3 went(Vec3 from, double t0, double t1) { return from + Vec3(U * (t1 - t0), V / w * (std::sin(w * t1) - std::sin(w * t0)), 0); }

inline const auto big_box = [](double) -> Mesh { return grid(5, {-2, -2, -2}, {2, 2, 2}); };

inline Series oscillating_series(size_t steps, double end = 2, bool f32 = false) {
  return series_of(even_times(0, end, steps), big_box, oscillating, f32);
}

// The double gyre of Shadden et al. 2005 in [0, 2] x [0, 1].
inline const auto gyre = [](Vec3 x, double t) {
  const double a = 0.25 * std::sin(2 * M_PI * t / 10), b = 1 - 2 * a, f = a * x.x * x.x + b * x.x;
  return Vec3(-M_PI * 0.1 * std::sin(M_PI * f) * std::cos(M_PI * x.y),
              M_PI * 0.1 * std::cos(M_PI * f) * std::sin(M_PI * x.y) * (2 * a * x.x + b), 0);
};
inline Series gyre_series(size_t n, std::vector<double> times) {
  return series_of(
      std::move(times),
      [n](double) -> Mesh {
        UniformGrid g;
        g.dims = {2 * n + 1, n + 1, 1};
        g.spacing = {1.0 / double(n), 1.0 / double(n), 1};
        return g;
      },
      gyre);
}

template <class P>
P seeded_at(std::vector<double> points) {
  P p;
  p.seeds.points = std::move(points);
  return p;
}

struct Lines {
  DatasetPtr data;
  const SurfaceMesh& mesh() const { return *data->as<SurfaceMesh>(); }
  Vec3 x(size_t i) const { return mesh().points.at(i); }
  double value(const char* field, size_t i) const { return data->fields().require(field).array.get(i); }
  size_t points() const { return data->point_count(); }
};

inline void check_same_bytes(const Dataset& a, const Dataset& b) {
  REQUIRE(a.fields().size() == b.fields().size());
  const Points& p = a.as<SurfaceMesh>() ? a.as<SurfaceMesh>()->points : a.as<PointCloud>()->points;
  const Points& q = b.as<SurfaceMesh>() ? b.as<SurfaceMesh>()->points : b.as<PointCloud>()->points;
  REQUIRE(p.count() == q.count());
  CHECK(std::memcmp(p.xyz.raw(), q.xyz.raw(), p.xyz.bytes()) == 0);
  for (const Field& f : a.fields()) {
    const Array& other = b.fields().require(f.name, f.association).array;
    REQUIRE(other.bytes() == f.array.bytes());
    CHECK(std::memcmp(other.raw(), f.array.raw(), f.array.bytes()) == 0);
  }
}

}  // namespace sg::test::unsteady
