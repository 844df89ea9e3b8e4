// SPDX-License-Identifier: Apache-2.0
// Series of analytic flows for the tests of unsteady tracing.
#pragma once
#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "data/dataset.h"
#include "data/lattice.h"
#include "filter/flow/flow_support.h"

namespace sg::test {

/// The mesh with a field "velocity" v(x), and "height" z + x.
inline DatasetPtr with_velocity(const Mesh& mesh, const std::function<Vec3(Vec3)>& v, bool f32 = false) {
  FieldSet fields;
  fields.add({"velocity", Association::point, f32 ? at_points<float>(mesh, v) : at_points(mesh, v), "", Role::none});
  fields.add({"height", Association::point,
              at_points(
                  mesh, [](Vec3 x) { return Vec3(x.z + x.x, 0, 0); }, 1),
              "", Role::none});
  return make_dataset(mesh, fields);
}

inline UniformGrid grid(size_t n, Vec3 lo, Vec3 hi, size_t nz = 0) {
  UniformGrid g;
  g.dims = {n, n, nz ? nz : n};
  g.origin = lo;
  for (int a = 0; a < 3; ++a) g.spacing[a] = g.dims[size_t(a)] > 1 ? (hi[a] - lo[a]) / double(g.dims[size_t(a)] - 1) : 1;
  return g;
}

inline std::vector<double> even_times(double a, double b, size_t n) {
  std::vector<double> t(n);
  for (size_t i = 0; i < n; ++i) t[i] = i + 1 == n ? b : a + (b - a) * double(i) / double(n - 1);
  return t;
}

/// Watches how many of its steps live.
struct Watched {
  std::vector<std::weak_ptr<const Dataset>> steps;
  size_t most = 0, loads = 0;
};

/// v(x, t) on a mesh per time.
inline Series series_of(std::vector<double> times, std::function<Mesh(double)> mesh, std::function<Vec3(Vec3, double)> v, bool f32 = false,
                        std::shared_ptr<Watched> watched = {}) {
  Series s;
  s.times = times;
  s.load = [=](size_t k) -> Data {
    const double t = times[k];
    DatasetPtr d = with_velocity(
        mesh(t), [&](Vec3 x) { return v(x, t); }, f32);
    if (watched) {
      ++watched->loads;
      std::erase_if(watched->steps, [](const auto& w) { return w.expired(); });
      watched->steps.push_back(d);
      watched->most = std::max(watched->most, watched->steps.size());
    }
    return d;
  };
  return s;
}

}  // namespace sg::test
