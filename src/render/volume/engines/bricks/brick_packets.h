// SPDX-License-Identifier: Apache-2.0
// Packets of rays through the bricks of a volume larger than memory: brick by brick from front to back.
#pragma once
#include "data/memory/byte_cache.h"
#include "render/volume/engines/packets/packets.h"
#include "render/volume/sources/bricks/brick_source.h"

namespace sg::volume {

/// What the lattices of all bricks share: all but the samples. `unit`: world length to which opacity refers.
Volume brick_stage(const BrickedSource& source, const VolumeItem& item, uint32_t id, double unit, float per_scale);

/// What the rays of a picture share.
struct BrickPlan {
  const Projection& projection;
  bool simd, skip_empty;  ///< of Knobs
  float stop_below;       ///< in steps: early ray termination
  Illumination light;
  const Medium* medium;
  Budget budget;
  bool in_steps;  ///< fixed steps, else within the tolerance
};

/// One volume alone. Draws what single rays through the source draw, except where two levels meet: there the levels are mixed at the
/// samples and linear between them.
class BrickPackets {
 public:
  /// Whether this can be drawn so: as in_packets(), and lattice_key() can distinguish the bricks.
  static bool fits(const BrickedSource& source, const VolumeItem& item, const BrickPlan& plan);

  /// `stage` as brick_stage() makes it. The source must have its Invisible. All of them, and the plan's medium, must outlive this.
  BrickPackets(const BrickedSource& source, const Volume& stage, BrickPlan plan, const Context& context);

  /// Composites the pixels [x0, x1) x [y0, y1) before what is in the frame, as draw_tile() does; reads bricks as rays reach them.
  void draw(int x0, int y0, int x1, int y1, Frame& frame) const;

 private:
  struct Leaf {
    int node;
    float x0, y0, x1, y1;  ///< what it covers in the picture: pixels
    std::array<Vec2, 8> corner;
    bool all = false;  ///< it reaches behind the eye: anything
  };
  bool meets(const Leaf& leaf, double x0, double y0, double x1, double y1) const;
  /// The lattice of a leaf as the volume of a plan, and the part that it is; false when there is nothing to draw.
  bool load(const BrickNode& node, Volume& volume, LatticePart& part, std::shared_ptr<const BrickLattice>& lattice) const;

  const BrickedSource& source_;
  const Volume& stage_;
  BrickPlan plan_;
  const Context& context_;
  std::vector<Leaf> leaves_;  // front to back
  mutable ByteCache<BrickSpace> spaces_{size_t(32) << 20};
};

}  // namespace sg::volume
