// SPDX-License-Identifier: Apache-2.0
// The fast way through one volume of a lattice: neighbouring rays go together, one per vector lane.
#pragma once
#include <vector>

#include "render/shade/lamp.h"
#include "render/volume/engines/packets/gathers.h"
#include "render/volume/engines/packets/passages.h"
#include "render/volume/medium/medium_sums.h"
#include "render/volume/rays/integrate.h"
#include "render/volume/sources/lattice/lattice_volume.h"
#include "render/volume/sources/lattice/uneven_axes.h"
#include "scene/camera.h"

namespace sg::volume {

struct DetailTable;

/// What the rays of a picture share.
struct PacketPlan {
  static constexpr size_t most_lamps = 8;

  const Volume& volume;
  const Projection& projection;
  Knobs knobs;
  std::vector<Lamp> lamps;  ///< of a shaded volume
  Material material;        ///< power: whole_power
  // Of the integral within a tolerance:
  const Medium* medium = nullptr;
  Budget budget;
  float edge = 1;
  const MediumSums* sums = nullptr;     ///< of the medium; null: cells are crossed one by one
  const Passages* passages = nullptr;   ///< of the volume
  const SpaceAhead* ahead = nullptr;    ///< of the volume, where there are no passages; null: by its distances
  const UnevenAxes* uneven = nullptr;   ///< of a rectilinear grid
  const DetailTable* detail = nullptr;  ///< where opacity hangs on the gradient, too; not with uneven
  /// One lattice of several, drawn from front to back: what is in the frame lies before it, and rays go on with the light that is left (1 -
  /// alpha). The depth where half of it is gone goes here, for each pixel of the frame (infinite: not yet), instead of into the frame.
  float* half = nullptr;
  Vec3 whole_lo{}, whole_hi{};    ///< of all of them, in the q space of this one: steps are counted from where rays enter this box
  std::vector<ClipPlane> clip{};  ///< not with `half`
};

/// Is the power of highlights one that packets multiply out?
inline bool whole_power(const Material& m) { return m.power >= 0 && m.power <= 4096 && m.power == float(int(m.power)); }

/// May this volume be drawn by `march_tile`: affine, linear between samples, a linear transfer table, no hidden cells, offsets
/// of 32 bits? The others go by single rays (rays/cast.h).
bool in_packets(const PacketPlan& plan);

/// Draws the pixels [x0, x1) x [y0, y1): fixed steps of volume.step, or the maximum, behind nothing and before what is in the frame
/// (opaque surfaces by its depth). Notes depth and id where the volume takes half of the light and nothing opaque lies behind. Bytes
/// depend neither on the borders of tiles nor on the width of vectors; knobs.simd = false takes one ray at a time.
void march_tile(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame);

/// May this volume be drawn by `cast_tile`: as above; rectilinear grids, too, with plan.uneven.
bool in_tolerant_packets(const PacketPlan& plan);

/// The same within plan.budget instead of in steps. For tests: knobs.simd = false takes one ray at a time, with the same bytes.
void cast_tile(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame);

}  // namespace sg::volume
