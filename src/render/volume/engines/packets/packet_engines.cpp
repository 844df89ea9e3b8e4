// SPDX-License-Identifier: Apache-2.0
// Lattices by packets of rays: the plan of each engine, with the tables that it reads.
#include <optional>

#include "render/volume/engines/engine.h"
#include "render/volume/engines/packets/detail_table.h"
#include "render/volume/engines/packets/packets.h"
#include "render/volume/engines/packets/scattered_light.h"
#include "render/volume/sources/lattice/reconstructed_ray.h"

namespace sg::volume {

namespace {

/// Draws by a plan.
template <class Plan>
class PacketEngine : public TileEngine {
 public:
  const Volume* blocks() const override { return &plan_.volume; }
  void draw(int x0, int y0, int x1, int y1, Frame& frame) const override { draw_tile(plan_, x0, y0, x1, y1, frame); }

 protected:
  explicit PacketEngine(Plan plan) : plan_(std::move(plan)) {}
  Plan plan_;
};

PrimaryRays rays_of(const EngineInput& in) { return {*in.lattice, in.projection, in.knobs.simd, in.item().clip}; }
Illumination light_of(const EngineInput& in) { return {in.shaded ? in.lamps : std::vector<Lamp>(), in.volume.material}; }
IntegralPlan integral_of(const EngineInput& in) { return {rays_of(in), light_of(in), in.volume.medium.get(), in.volume.budget}; }

/// Is there something empty to leap over?
bool leaps(const EngineInput& in) { return in.knobs.skip_empty && in.lattice->any_empty; }
SpaceAhead space_ahead(const EngineInput& in) {
  return {in.lattice->distance, in.lattice->fine().dims, Ways::of(in.projection, in.lattice->to_q)};
}
Passages passages(const EngineInput& in) {
  auto bends = bends_of(in.item(), *in.lattice);
  return leaps(in) ? Passages(std::move(bends), space_ahead(in)) : Passages(std::move(bends));
}

class StridingPackets : public PacketEngine<StridingPlan> {
 public:
  explicit StridingPackets(const EngineInput& in)
      : PacketEngine(StridingPlan{integral_of(in), nullptr, in.knobs.skip_empty}), tables_{MediumSums(*in.volume.medium), passages(in)} {
    plan_.tables = &tables_, plan_.turns = in.knobs.turns;
    if (in.volume.effects) plan_.scattered = &scattered_.emplace(*in.volume.effects, in.lamps, *in.lattice);
  }

 private:
  const StrideTables tables_;
  std::optional<ScatteredLight> scattered_;
};

class UnevenPackets : public PacketEngine<UnevenPlan> {
 public:
  explicit UnevenPackets(const EngineInput& in) : PacketEngine(UnevenPlan{integral_of(in)}), axes_(*in.lattice) {
    plan_.axes = &axes_;
    if (leaps(in)) plan_.ahead = &ahead_.emplace(space_ahead(in));
  }

 private:
  const UnevenAxes axes_;
  std::optional<SpaceAhead> ahead_;
};

class DetailPackets : public PacketEngine<DetailPlan> {
 public:
  explicit DetailPackets(const EngineInput& in)
      : PacketEngine(DetailPlan{integral_of(in)}), table_(in.item(), *in.volume.detail, double(in.volume.source->base)) {
    plan_.table = &table_;
    if (leaps(in)) plan_.ahead = &ahead_.emplace(space_ahead(in));
  }

 private:
  const DetailTable table_;
  std::optional<SpaceAhead> ahead_;
};

class MarchingPackets : public PacketEngine<MarchingPlan> {
 public:
  explicit MarchingPackets(const EngineInput& in)
      : PacketEngine(MarchingPlan{rays_of(in), light_of(in), in.knobs.stop_below, in.knobs.skip_empty}) {
    if (leaps(in)) plan_.ahead = &ahead_.emplace(space_ahead(in));
  }

 private:
  std::optional<SpaceAhead> ahead_;
};

class MaximumPackets : public PacketEngine<MaximumPlan> {
 public:
  explicit MaximumPackets(const EngineInput& in) : PacketEngine(MaximumPlan{rays_of(in), in.knobs.skip_empty}) {}
};

/// A lattice that packets read.
bool in_packets(const EngineInput& in) { return in.lattice && !wants_reconstruction(in.item().sampling) && in_packets(*in.lattice); }
/// The same, lit.
bool lit_in_packets(const EngineInput& in) { return in_packets(in) && in_packets(light_of(in)); }

}  // namespace

std::unique_ptr<TileEngine> tolerant_packets(const EngineInput& in) {
  if (!in.by_tolerance() || !lit_in_packets(in) || !in.volume.medium->linear()) return nullptr;
  if (const Detail* detail = in.volume.detail.get()) {
    if (!in.lattice->affine || !DetailTable::fits(in.item(), *detail)) return nullptr;
    return std::make_unique<DetailPackets>(in);
  }
  if (in.lattice->affine) return std::make_unique<StridingPackets>(in);
  return std::make_unique<UnevenPackets>(in);
}

std::unique_ptr<TileEngine> scattering_packets(const EngineInput& in) {
  const bool fits = in.by_tolerance() && lit_in_packets(in) && in.volume.medium->linear() && !in.volume.detail && in.lattice->affine;
  return fits && scatters_alone(*in.volume.effects) ? std::make_unique<StridingPackets>(in) : nullptr;
}

std::unique_ptr<TileEngine> marching_packets(const EngineInput& in) {
  if (!in.by_samples() || in.by_tolerance() || in.volume.detail || !lit_in_packets(in) || !in.lattice->affine) return nullptr;
  return std::make_unique<MarchingPackets>(in);
}

std::unique_ptr<TileEngine> maximum_packets(const EngineInput& in) {
  if (in.item().mode != RayFunction::maximum || in.volume.detail || !in_packets(in) || !in.lattice->affine) return nullptr;
  return std::make_unique<MaximumPackets>(in);
}

}  // namespace sg::volume
