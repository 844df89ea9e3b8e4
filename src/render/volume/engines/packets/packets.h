// SPDX-License-Identifier: Apache-2.0
// The fast way through one volume of a lattice: neighbouring rays go together, one per vector lane. Each engine has a plan: what the rays
// of a picture share.
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
struct ScatteredLight;

/// The rays from the viewer: what all plans begin with.
struct PrimaryRays {
  const Volume& volume;
  const Projection& projection;
  bool simd = true;               ///< for tests; false takes one ray at a time, with the same bytes
  std::vector<ClipPlane> clip{};  ///< not with a part
};

/// Lights on the surfaces that gradients make, and what these are made of; read where the volume is shaded.
struct Illumination {
  static constexpr size_t most_lamps = 8;
  std::vector<Lamp> lamps{};
  Material material{};  ///< power: whole_power
};

/// One lattice of several, drawn from front to back: what is in the frame lies before it, and rays go on with the light that is left (1 -
/// alpha).
struct LatticePart {
  float* half;  ///< for each pixel of the frame, in the place of its own: the depth where half of the light is gone (infinite: not yet)
  Vec3 whole_lo{}, whole_hi{};  ///< of all of them, in the q space of this one: steps are counted from where rays enter this box
  float stop_below = 0;         ///< rays with less light than this do not enter
};

/// Maximum intensity projection. Volumes as for MarchingPlan.
struct MaximumPlan : PrimaryRays {
  bool skip_empty = true;  ///< pass over bricks that hold no larger value
};

/// Ray marching: samples in fixed steps of volume.step.
struct MarchingPlan : PrimaryRays {
  Illumination light{};
  float stop_below = 0;               ///< early ray termination
  bool skip_empty = true;             ///< leap over empty bricks
  const SpaceAhead* ahead = nullptr;  ///< of the volume, where rays leap; null: by its distances
  const LatticePart* part = nullptr;
};

/// The volume rendering integral within a tolerance: what its three plans share.
struct IntegralPlan : PrimaryRays {
  Illumination light;
  const Medium* medium;
  Budget budget;
  const ScatteredLight* scattered = nullptr;  ///< of volumes that are not shaded, on uniform grids
};

/// What strides over several cells look up.
struct StrideTables {
  MediumSums sums;    ///< of the medium
  Passages passages;  ///< of the volume
};

/// Uniform grids: in strides where the field is nearly straight.
struct StridingPlan : IntegralPlan {
  const StrideTables* tables = nullptr;  ///< null: cell by cell
  bool skip_empty = true;                ///< without tables: leap over empty bricks by the volume's distances
  const LatticePart* part = nullptr;
  std::atomic<uint64_t>* turns = nullptr;  ///< as in Knobs
};

/// Rectilinear grids, cell by cell.
struct UnevenPlan : IntegralPlan {
  const UnevenAxes* axes = nullptr;
  const SpaceAhead* ahead = nullptr;  ///< null: no brick is empty
};

/// Uniform grids where opacity depends on the gradient, too, cell by cell.
struct DetailPlan : IntegralPlan {
  const DetailTable* table = nullptr;
  const SpaceAhead* ahead = nullptr;  ///< null: no brick is empty
};

/// Is the power of highlights one that packets multiply out?
inline bool whole_power(const Material& m) { return m.power >= 0 && m.power <= 4096 && m.power == float(int(m.power)); }

/// May packets read this lattice: linear between samples, a linear transfer table, no hidden cells, offsets of 32 bits? In fixed steps and
/// for maxima it must be affine, too. The others go by single rays (rays/cast.h).
bool in_packets(const Volume& volume);
/// May packets light it so?
bool in_packets(const Illumination& light);

/// Draws the pixels [x0, x1) x [y0, y1) behind nothing and before what is in the frame (opaque surfaces by its depth). Notes depth and id
/// where the volume takes half of the light and nothing opaque lies behind. Bytes depend neither on the borders of tiles nor on the width
/// of vectors.
void draw_tile(const MaximumPlan& plan, int x0, int y0, int x1, int y1, Frame& frame);
void draw_tile(const MarchingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame);
/// The same, within plan.budget, for media with Medium::linear().
void draw_tile(const StridingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame);
void draw_tile(const UnevenPlan& plan, int x0, int y0, int x1, int y1, Frame& frame);
void draw_tile(const DetailPlan& plan, int x0, int y0, int x1, int y1, Frame& frame);

}  // namespace sg::volume
