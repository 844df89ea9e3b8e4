// SPDX-License-Identifier: Apache-2.0
// Volumes that memory does not hold, by packets of rays.
#include <optional>

#include "render/volume/engines/bricks/brick_packets.h"
#include "render/volume/engines/engine.h"

namespace sg::volume {

namespace {

class BrickEngine : public TileEngine {
 public:
  BrickEngine(const EngineInput& in, const BrickedSource& source)
      : stage_(brick_stage(source, in.item(), in.volume.id, in.volume.unit, in.volume.per_scale)) {
    BrickPlan plan{in.projection,
                   in.knobs.simd,
                   in.knobs.skip_empty,
                   in.knobs.stop_below,
                   {in.shaded ? in.lamps : std::vector<Lamp>(), in.volume.material},
                   in.volume.medium.get(),
                   in.volume.budget,
                   !in.by_tolerance()};
    if (BrickPackets::fits(source, in.item(), plan)) packets_.emplace(source, stage_, std::move(plan), in.context);
  }
  /// False where packets do not fit.
  bool fits() const { return packets_.has_value(); }
  void draw(int x0, int y0, int x1, int y1, Frame& frame) const override { packets_->draw(x0, y0, x1, y1, frame); }
  const Volume* blocks() const override { return &stage_; }

 private:
  Volume stage_;
  std::optional<BrickPackets> packets_;
};

}  // namespace

std::unique_ptr<TileEngine> brick_engine(const EngineInput& in) {
  const auto* source = dynamic_cast<const BrickedSource*>(in.volume.source.get());
  if (!source || in.lattice || in.volume.detail || !in.item().clip.empty() || !in.knobs.bricks_in_packets) return nullptr;
  if (!in.by_tolerance() && !in.by_samples()) return nullptr;
  auto engine = std::make_unique<BrickEngine>(in, *source);
  return engine->fits() ? std::move(engine) : nullptr;
}

}  // namespace sg::volume
