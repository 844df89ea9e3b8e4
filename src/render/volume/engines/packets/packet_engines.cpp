// SPDX-License-Identifier: Apache-2.0
// Lattices by packets of rays: the plans of both engines, with the tables that they read.
#include <optional>

#include "render/volume/engines/engine.h"
#include "render/volume/engines/packets/detail_table.h"
#include "render/volume/engines/packets/packets.h"
#include "render/volume/sources/lattice/reconstructed_ray.h"

namespace sg::volume {

namespace {

class PacketEngine : public TileEngine {
 public:
  explicit PacketEngine(const EngineInput& in)
      : plan{*in.lattice,        in.projection,          in.knobs,         {},
             in.volume.material, in.volume.medium.get(), in.volume.budget, float(in.volume.source->edge)} {
    if (in.shaded) plan.lamps = in.lamps;
    plan.clip = in.item().clip;
  }
  const Volume* blocks() const override { return &plan.volume; }

  PacketPlan plan;

 protected:
  /// Where there is something empty to leap over.
  void look_ahead(const EngineInput& in) {
    if (leaps(in)) plan.ahead = &ahead_.emplace(space_ahead(in));
  }
  static bool leaps(const EngineInput& in) { return in.knobs.skip_empty && in.lattice->any_empty; }
  static SpaceAhead space_ahead(const EngineInput& in) {
    return {in.lattice->distance, in.lattice->fine().dims, Ways::of(in.projection, in.lattice->to_q)};
  }

 private:
  std::optional<SpaceAhead> ahead_;
};

class TolerantPackets : public PacketEngine {
 public:
  using PacketEngine::PacketEngine;

  void read(const EngineInput& in) {
    const Volume& lattice = *in.lattice;
    if (in.volume.detail) {
      plan.detail = &detail_.emplace(in.item(), *in.volume.detail, double(in.volume.source->base));
      look_ahead(in);
    } else if (lattice.affine) {
      plan.sums = &sums_.emplace(*in.volume.medium);
      auto bends = bends_of(in.item(), lattice);
      if (leaps(in)) passages_.emplace(std::move(bends), space_ahead(in));
      else passages_.emplace(std::move(bends));
      plan.passages = &*passages_;
    } else {
      plan.uneven = &uneven_.emplace(lattice);
      look_ahead(in);
    }
  }
  void draw(int x0, int y0, int x1, int y1, Frame& frame) const override { cast_tile(plan, x0, y0, x1, y1, frame); }

 private:
  std::optional<MediumSums> sums_;
  std::optional<Passages> passages_;
  std::optional<UnevenAxes> uneven_;
  std::optional<DetailTable> detail_;
};

class MarchingPackets : public PacketEngine {
 public:
  explicit MarchingPackets(const EngineInput& in) : PacketEngine(in) {
    if (in.by_samples()) look_ahead(in);
  }
  void draw(int x0, int y0, int x1, int y1, Frame& frame) const override { march_tile(plan, x0, y0, x1, y1, frame); }
};

}  // namespace

std::unique_ptr<TileEngine> tolerant_packets(const EngineInput& in) {
  if (!in.lattice || !in.by_tolerance() || wants_reconstruction(in.item().sampling)) return nullptr;
  if (const Detail* detail = in.volume.detail.get(); detail && !(in.lattice->affine && DetailTable::fits(in.item(), *detail)))
    return nullptr;
  auto engine = std::make_unique<TolerantPackets>(in);
  if (!in_tolerant_packets(engine->plan)) return nullptr;
  engine->read(in);
  return engine;
}

std::unique_ptr<TileEngine> marching_packets(const EngineInput& in) {
  if (!in.lattice || in.by_tolerance() || in.volume.detail || wants_reconstruction(in.item().sampling)) return nullptr;
  if (!in.by_samples() && in.item().mode != RayFunction::maximum) return nullptr;
  auto engine = std::make_unique<MarchingPackets>(in);
  return in_packets(engine->plan) ? std::move(engine) : nullptr;
}

}  // namespace sg::volume
