// SPDX-License-Identifier: Apache-2.0
// The path that a point of the space of random numbers is.
#pragma once
#include <vector>

#include "render/trace/integrators/bidirectional/primary_space.h"
#include "render/trace/integrators/bidirectional/strategies.h"

namespace sg::trace {

/// The paths of one point: what they add where, and how bright that is.
struct Lit {
  struct Splat {
    Vec2f pixel;
    Vec3 value;
  };
  std::vector<Splat> splats;
  double brightness = 0;
};

class PathOfPoint {
 public:
  /// Of a scene that stays.
  explicit PathOfPoint(const PathScene& scene) : scene_(scene), strategies_(scene) {}

  /// Kinds of paths, from 1 on: by their number of turns, and where there are media one more for all that turn more often than surfaces let
  /// them.
  int kinds() const { return scene_.bounces + (scene_.turns > scene_.bounces); }
  /// All paths of a kind, of one number of turns, by one of the turns + 2 ways to make them, each weighed up by that number, by the chance
  /// of the number of turns, and by its share: over all points their mean is what such paths add to the picture, by the number of its
  /// pixels.
  void trace(PrimarySpace& numbers, int kind, Lit& lit);

 private:
  const PathScene& scene_;
  Strategies strategies_;
  SubPath camera_, light_;
};

}  // namespace sg::trace
