// SPDX-License-Identifier: Apache-2.0
// Forces that a particle feels by itself: gravity, drag, a field, a tether.
#pragma once
#include <cmath>
#include <span>
#include <vector>

#include "base/vec.h"
#include "simulate/particles/wind.h"

namespace sg::swarm {

/// a = gravity - (drag + quadratic |v - u|) (v - u) + strength F / mass - tether (x - home) / mass, with the wind u and the force F of a
/// field; masses are equal.
struct LocalForces {
  Vec3 gravity;
  double drag = 0, quadratic = 0, tether = 0, mass = 1;
  const Wind* field = nullptr;
  bool is_wind = true;
  double strength = 1;
  std::span<const Vec3> home = {};  ///< of these particles, with tether
  bool flat = false;                ///< nothing moves along z

  void operator()(std::span<const Vec3> x, std::span<const Vec3> v, double, std::span<Vec3> a) const {
    if (field) field->sample(x, a);
    for (size_t i = 0; i < x.size(); ++i) {
      const Vec3 f = field ? strength * a[i] : Vec3();
      const Vec3 relative = is_wind ? v[i] - f : v[i];
      const double k = quadratic > 0 ? drag + quadratic * length(relative) : drag;
      Vec3 sum = gravity - k * relative;
      if (!is_wind) sum += (1 / mass) * f;
      if (tether > 0) sum += (tether / mass) * (home[i] - x[i]);
      if (flat) sum.z = 0;
      a[i] = sum;
    }
  }
};

}  // namespace sg::swarm
