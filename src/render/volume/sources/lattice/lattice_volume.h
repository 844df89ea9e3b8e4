// SPDX-License-Identifier: Apache-2.0
// The parts of the volume ray caster, for its own files and its tests.
//
// A volume has three spaces: world; "q", in which the sides of the cells are planes of constant coordinate (index space for
// uniform grids, world coordinates per axis for rectilinear ones); and "u", sample indices, where sample i lies at u = i.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "index/minmax_bricks.h"
#include "render/volume/medium/ray_state.h"
#include "render/volume/medium/transfer.h"
#include "render/volume/sources/lattice/bends.h"
#include "render/volume/sources/lattice/kernels.h"
#include "render/volume/sources/lattice/space/empty_space.h"
#include "scene/scene.h"

namespace sg::volume {

/// Switches for tests and benchmarks; the picture must not depend on them (except `stop_below`, by less than 1/255).
struct Knobs {
  bool skip_empty = true;                        ///< skip empty bricks
  float stop_below = 1.0f / 512;                 ///< a ray ends when less than this share of the light passes
  bool simd = true;                              ///< false: the scalar reference
  bool bricks_in_packets = true;                 ///< false: single rays through volumes larger than memory
  double coarser = 1;                            ///< RenderOptions::coarser
  const std::vector<uint8_t>* wanted = nullptr;  ///< per tile of 16 x 16 pixels, see composite_volumes; null = all
  std::atomic<uint64_t>* turns = nullptr;        ///< gets how often rays within a tolerance went on, in uniform grids
};
void composite_volumes(const Scene& scene, const Projection& projection, const FragmentLists& fragments, Frame& frame, Context& context,
                       const Knobs& knobs);

/// What a volume needs of its field, whatever the view: kept in the dataset's memo.
struct LatticeSamples {
  Voxels voxels;
  float base = 0;                        ///< value = stored + base
  std::vector<uint8_t> hidden;           ///< per cell of the lattice: draws nothing; may be empty
  FineBricks fine;                       ///< for empty space
  MinMaxBricks bricks;                   ///< for maxima
  double lo = HUGE_VAL, hi = -HUGE_VAL;  ///< of the finite values stored; lo > hi when there are none
  bool holes = false;                    ///< samples are cells, some without a value
  bool infinite = false;                 ///< some values stored are
};

struct Volume {
  uint32_t id = 0;  ///< item number + 1
  VolumeItem::Mode mode = VolumeItem::Mode::composite;
  bool shaded = false;
  bool nearest = false;  ///< labels: no value between two samples
  bool dual = false;     ///< samples are cells: a cell without a value does not affect its neighbours' halves
  Voxels voxels;
  float base = 0;                  ///< value = stored + base
  double step = 1;                 ///< world length
  double edge = 1;                 ///< world length of the smallest cell edge
  Box3 bounds;                     ///< world
  std::vector<Transfer> transfer;  ///< one
  Kernels kernels{};
  bool direct = false;   ///< a linear table and no holes: packets may draw it
  bool spanned = false;  ///< no value lies beyond the ends of the table
  ShadePlan shade_plan{};

  // world -> q
  Vec3 origin;
  Mat3 to_q;
  Vec3 lo, hi;                          ///< box in q
  bool affine = true;                   ///< q = u; else u from `coordinates`
  std::vector<double> coordinates[3];   ///< q of each sample, ascending
  std::vector<uint32_t> first_cell[3];  ///< cell in which a slice of the axis begins
  double slices_per_q[3] = {};

  std::shared_ptr<const LatticeSamples> samples;
  Distances distance;                             ///< in fine bricks to the next that draws something (composite)
  bool any_empty = true;                          ///< whether some brick draws nothing
  std::vector<double> border[3], fine_border[3];  ///< q of the sides of bricks, dims+1
  Vec3 margin;                                    ///< q: bound on rounding errors of positions

  const MinMaxBricks& bricks() const { return samples->bricks; }
  const FineBricks& fine() const { return samples->fine; }
  const std::vector<uint8_t>& hidden() const { return samples->hidden; }

  /// q = u, and all of the volume lies between samples; on axes where 32-bit positions along rays are off by less than a cell.
  bool within_samples() const;
  Vec3 q(Vec3 world) const { return to_q * (world - origin); }
  /// Sample index of a place in q along one axis, clamped.
  float u(int axis, double q) const;
  /// q-length of a cell there.
  double cell_length(int axis, double q) const;
};

/// Reads the item, checks it, converts and indexes its field. Throws Error(usage) for what cannot be shown as a volume.
/// If there is nothing to draw (a grid without extent), the box is empty.
Volume prepare(const VolumeItem& item, uint32_t id, const Knobs& knobs);

/// How far its field bends; computed once for all pictures of the field.
std::shared_ptr<const Bends> bends_of(const VolumeItem& item, const Volume& volume);

/// One ray in the q space of a volume: q = start + t * along, t the world length from the ray's origin.
struct Course {
  Vec3 start, along;
  double enter = 0, leave = -1;  ///< inside the box, and within the limits asked for
};
Course course(const Volume& volume, Vec3 origin, Vec3 direction, double from, double to);

}  // namespace sg::volume
