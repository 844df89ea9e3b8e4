// SPDX-License-Identifier: Apache-2.0
// Solid bodies in the flow, still or on their way.
#pragma once
#include <vector>

#include "base/context.h"
#include "simulate/fluid/smoke_params.h"
#include "simulate/fluid/walls/cover.h"
#include "simulate/fluid/walls/walls.h"

namespace sg::fluid {

/// Balls, and one closed surface. They move as one body, at the velocity and with the spin of the parameters about their middle.
class Solids {
 public:
  Solids() = default;
  /// Throws Error(usage) for balls that are none.
  Solids(const SmokeParams& p, TriangleSoup surface, const MacGrid& g);

  bool none() const { return balls_.empty() && surface_.empty(); }
  bool move() const { return moves_; }
  /// Of the fastest point.
  double speed() const { return speed_; }
  /// A point in a ball goes to the ball's surface at that time, and no faster into it than the ball moves; returns whether there was one.
  bool keep_out(Vec3& x, Vec3& v, double time) const;
  /// Walls at a time, with the velocity of what moves. Throws Error(data) where nothing is left for the flow.
  template <class T>
  Walls<T> walls(const Sides& sides, double time, const Context& context) const;

 private:
  Vec3 turned(Vec3 p, double time) const;  // where what begins at p is then

  MacGrid grid_;
  std::vector<Ball> balls_;
  TriangleSoup surface_;
  Vec3 middle_, velocity_, spin_;
  bool moves_ = false;
  double speed_ = 0;
};

}  // namespace sg::fluid
