// SPDX-License-Identifier: Apache-2.0
// TetRays: emission and absorption of a field that is linear in each tetrahedron, for a whole picture: the fast way.
//
// All pixels of a block walk at the same time, one lane each, as TetWalk does it, in floats relative to the eye and the middle depth of
// the mesh. In a tetrahedron the value is linear; its optical depth D and its light without attenuation come exactly from integrals of
// the medium over the value, in constant time. Attenuation within a segment is exact for colours that change evenly with the depth;
// deep segments are cut into parts (at most 1024) until the remaining error, from the change of colour where tau is not constant, is small
// against the light that they absorb. Light comes from gradients at the vertices, linear in each tetrahedron; segments are cut where the
// surface turns over, and until the light is nearly linear within the parts.
#pragma once
#include <vector>

#include "render/shade/lamp.h"
#include "render/volume/medium/medium.h"
#include "render/volume/sources/cells/eye_space.h"

namespace sg::volume {

/// A medium as the kernel reads it: pieces on which tau and colour are straight.
struct TetMedium {
  /// One line: values from lo to hi; tau, r, g, b at lo and their slopes; the integrals of tau and of tau times colour over the value
  /// up to lo, and of tau times the value beyond slice_lo. Constant beyond the ends.
  struct alignas(64) Interval {
    float lo, hi, at[4], slope[4], before[4], moment, unused;
  };
  /// Rounding remainders of these sums: next to practically opaque lines, and for narrow lines, differences of sums need them.
  struct alignas(32) Rest {
    float before[4], moment, unused[3];
  };
  static constexpr int most_parts = 1024;
  std::vector<Interval> intervals;
  std::vector<Rest> rests;
  bool long_sums = false;      ///< whether the remainders of `before` are needed
  bool long_moments = false;   ///< and those of moments
  std::vector<int32_t> first;  ///< per slice of the value: the interval of the slice before
  std::vector<int32_t> seen;   ///< slices before this one in which tau is not zero
  float slice_lo = 0, per_slice = 0;

  float fine = 24;  ///< segments deeper than 1 by this times the root of their change of colour are cut
  /// `range`: that of the data. Straight lines are accurate to a quarter of `tolerance` (of colours, and of tau relative to itself or to a
  /// fifth of the medium's faintest visible tau), parts of deep segments to a sixth of it.
  TetMedium(const Medium& medium, const Range& range, float tolerance = 1.0f / 512);
};

/// 16 rays: what they have gathered, and where each of them is.
struct alignas(64) TetPacket : RayLines {
  float length[lanes];              ///< ray length per depth
  float direction[3][lanes];        ///< world, unit
  float done[lanes], limit[lanes];  ///< depths: what lies before the one is drawn, beyond the other hidden
  int32_t tet[lanes];               ///< -1: this lane has nothing to do
  int32_t id[3][lanes];             ///< corners of the face where it enters, to the left around the line
  int32_t gone[lanes];              ///< result: the corner behind at the path's end
  int32_t last[lanes];              ///< result: the last tetrahedron, when the path ended at the boundary; else -1
  float r[lanes], g[lanes], b[lanes], pass[lanes];
  float half[lanes];  ///< depth at which half of the light was gone; NaN before
};

/// Light on the field by its gradient.
struct TetLight {
  std::vector<Lamp> lamps;
  Material material;
  float edge_per_scale = 1;          ///< see light_at
  float tolerance = 1.0f / 512;      ///< of a ray
  float per_ray = 1;                 ///< 1 / length of the longest one
  const float* gradients = nullptr;  ///< world, three numbers a vertex
};

/// What the kernel reads.
struct TetTables {
  const TetLink* links;
  const float* eye;          ///< x, y, depth, value of each vertex
  const float* cell_values;  ///< of cell fields, else null
  const uint32_t* cells;     ///< of tetrahedra; null: their own number
  const TetMedium* medium;
  const TetLight* light;  ///< null: not shaded
  float stop_below;
};

/// From the boundary to the boundary, in each lane. The same bits for any width of vectors.
void walk_tets(const TetTables& tables, TetPacket& packet);

class TetRays {
 public:
  static constexpr int tile = 16;
  struct Pixel {
    float r = 0, g = 0, b = 0, transmittance = 1;  ///< premultiplied linear colour
    float half = NAN;                              ///< depth at which half of the light was gone; NaN: nowhere
  };

  /// Whether this picture is of the field itself rather than of linear pieces that approximate it.
  static bool fits(const CellVolume& volume);
  /// Values are stored ones. Keeps references to `volume`.
  TetRays(const CellVolume& volume, const Projection& projection, const Medium& medium, Context& context, float stop_below = 1.0f / 4096,
          float tolerance = 1.0f / 512);
  /// Lights the field from now on; the lamps of the scene, in world directions. `per_scale` as in Look. Powers of highlights count as
  /// whole numbers.
  void light(std::vector<Lamp> lamps, const VolumeLight& light, float per_scale);

  /// Pixels [x0, x0 + width) x [y0, y0 + height), x0 and y0 multiples of `tile`, width and height at most that. `limit`: depth per pixel,
  /// row by row, beyond which nothing is drawn; null = the far plane.
  void draw(int x0, int y0, int width, int height, const float* limit, Pixel* out) const;

 private:
  struct Hit {
    float depth;
    uint32_t face;
    uint8_t pixel, used;
  };
  struct Scratch;
  void find_hits(int x0, int y0, int width, int height, Scratch& s) const;
  const CellVolume& volume_;
  const Projection projection_;
  TetMedium medium_;
  float stop_below_, tolerance_;
  EyeSpace eye_;
  int across_ = 0, down_ = 0;
  std::optional<TetLight> light_;
  std::shared_ptr<const Plane<Vec3f>> gradients_;
  std::vector<uint32_t> first_face_, faces_;  // boundary faces by tile
};

}  // namespace sg::volume
