// SPDX-License-Identifier: Apache-2.0
// Backward Euler for particles that pull each other: Newton's method whose linear systems GMRES solves without a matrix.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "base/vec.h"

namespace sg::swarm {

using Accelerations = std::function<void(std::span<const Vec3> x, std::span<const Vec3> v, double t, std::span<Vec3> a)>;

/// The velocities w with w = v + h a(x + h w, w, t + h); products with the Jacobian matrix are central differences of a (Knoll, Keyes
/// 2004). Throws Error(data) where Newton's method finds nothing.
void implicit_velocities_together(const Accelerations& a, double t, double h, std::span<const Vec3> x, std::span<const Vec3> v,
                                  std::vector<Vec3>& w);

}  // namespace sg::swarm
