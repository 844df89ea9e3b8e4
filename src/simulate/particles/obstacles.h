// SPDX-License-Identifier: Apache-2.0
// Surfaces and a box that particles bounce off, however fast they are.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/vec.h"
#include "data/dataset.h"
#include "index/cell_locator.h"
#include "simulate/particles/near_cells.h"

namespace sg::swarm {

/// restitution: speed across the surface after a bounce as a share of that before; friction: Coulomb's coefficient.
struct Bounce {
  double restitution = 0.5, friction = 0;
};

class Obstacles {
 public:
  explicit Obstacles(Bounce bounce) : bounce_(bounce) {}
  /// Particles stay inside. May be flat along z.
  void set_box(const Box3& box) { box_ = box; }
  /// Surfaces, or the outsides of solid cells. Throws Error(usage) for meshes without cells.
  void add(const DatasetPtr& data, const std::string& who, Context& context);
  bool empty() const { return surfaces_.empty() && !box_; }
  /// Whether no way within a box meets anything; false may be wrong.
  bool free(const Box3& box) const;

  /// One per thread.
  class Walker {
   public:
    explicit Walker(const Obstacles& obstacles);
    /// On the way from x with velocity v to x1 with v1 in the time h: x1 and v1 become place and velocity after all bounces on it. The way
    /// between bounces is straight and ends before what it would meet, by 1e-9 of the scene's size: nothing is passed through. Returns
    /// whether there was a bounce.
    bool walk(Vec3 x, Vec3 v, Vec3& x1, Vec3& v1, double h);

   private:
    struct Hit {
      double t = HUGE_VAL;
      Vec3 normal{};
    };
    Hit first(Vec3 x, Vec3 d);
    const Obstacles& all_;
    std::vector<LocatorCursor> cursors_;
  };

 private:
  struct Surface {
    std::unique_ptr<CellLocator> locator;
    NearCells near;
  };
  Bounce bounce_;
  std::optional<Box3> box_;
  std::vector<Surface> surfaces_;
  double gap_ = 1e-9;  // what is left between a particle and what it has met
  friend class Walker;
};

}  // namespace sg::swarm
