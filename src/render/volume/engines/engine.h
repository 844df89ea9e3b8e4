// SPDX-License-Identifier: Apache-2.0
// TileEngine: a fast way to draw the only volume of a picture. What no engine can draw is drawn by single rays (rays/cast.h), which give
// the same within the tolerance.
#pragma once
#include <memory>
#include <vector>

#include "base/context.h"
#include "image/image.h"
#include "render/shade/lamp.h"
#include "render/volume/rays/cast.h"
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

constexpr int tile = 16;  ///< pixels; rays of a tile meet the same voxels

/// What an engine may read; all of it outlives the engine.
struct EngineInput {
  const CastVolume& volume;
  const Volume* lattice;  ///< of a uniform or rectilinear grid, else null
  const Projection& projection;
  const std::vector<Lamp>& lamps;
  bool shaded;  ///< whether there is any light
  const Knobs& knobs;
  Context& context;

  const VolumeItem& item() const { return *volume.item; }
  bool composite() const { return item().mode == RayFunction::composite; }
  bool by_tolerance() const { return composite() && !(volume.step > 0); }
  /// In fixed steps, classified sample by sample.
  bool by_samples() const { return composite() && item().sampling.classify == VolumeClassify::post && !item().sampling.jitter; }
};

class TileEngine {
 public:
  virtual ~TileEngine() = default;
  /// Composites the pixels [x0, x1) x [y0, y1) before what is in the frame. One tile where blocks() is null, else any number.
  virtual void draw(int x0, int y0, int x1, int y1, Frame& frame) const = 0;
  /// The volume in whose box all rays end, of engines that draw blocks of tiles; else null.
  virtual const Volume* blocks() const { return nullptr; }
};

/// Null where the engine cannot draw this volume.
using EngineFactory = std::unique_ptr<TileEngine> (*)(const EngineInput&);
std::unique_ptr<TileEngine> tolerant_packets(const EngineInput& input);    ///< lattices within the tolerance
std::unique_ptr<TileEngine> scattering_packets(const EngineInput& input);  ///< the same, in light that is scattered once
std::unique_ptr<TileEngine> marching_packets(const EngineInput& input);    ///< lattices in fixed steps
std::unique_ptr<TileEngine> maximum_packets(const EngineInput& input);     ///< maxima of lattices
std::unique_ptr<TileEngine> brick_engine(const EngineInput& input);        ///< volumes larger than memory
std::unique_ptr<TileEngine> tetrahedra_engine(const EngineInput& input);   ///< meshes of cells

/// The first of all engines that can draw this volume, or null.
std::unique_ptr<TileEngine> engine_for(const EngineInput& input);

}  // namespace sg::volume
