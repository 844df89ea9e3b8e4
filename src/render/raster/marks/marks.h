// SPDX-License-Identifier: Apache-2.0
// Lines and dots: shapes of constant width on the picture, covered softly at their edges. Internal to raster/.
#pragma once
#include <vector>

#include "render/raster/triangles/kernels.h"
#include "render/shade/shade.h"

namespace sg::raster {

/// A capsule from a to b, or a disc when both are the same; `w` is 1/z (perspective) or z (parallel).
struct MarkRecord {
  double ax, ay, aw, bx, by, bw;
  float from, to;  ///< places of a and b on the segment, after near clipping; equal for dots
  float half;      ///< half the width, pixels
  float fade = 1;  ///< factor of the coverage: edges of cells of a few pixels vanish
  float halo = 0;  ///< pixels around that hide what is behind
  uint32_t primitive;
  uint32_t item;  ///< of the prepared scene
  uint32_t group;
};

/// Part of a pixel covered by something; what the fragments are made from.
struct Cover {
  uint32_t pixel;  ///< in the tile
  float order;     ///< depth it is sorted and hidden by
  float depth;     ///< depth it has
  uint32_t primitive;
  uint32_t item;
  float alpha;   ///< coverage, later times opacity
  float s, t;    ///< line: place on the segment, 1 for its halo; dot: offset from the centre in radii
  float rgb[3];  ///< linear, not yet multiplied with alpha
};

/// Lines and dots of an item on the picture, those outside left out; in order of their primitives.
std::vector<MarkRecord> mark_records(const PreparedItem& item, uint32_t number, const Projection& projection, double pixel_scale);
/// Clips a segment of eye space by depth and puts it on the picture; false when nothing is left. half, primitive and group are given.
bool place_segment(const Projection& projection, Vec3 a, Vec3 b, MarkRecord& m);
PixelBox mark_box(const MarkRecord& m, int width, int height);

/// Coverage of a pixel whose centre is `distance` from the middle of a band `2 * half` wide; exact for bands along the pixel rows.
inline double band_coverage(double distance, double half) {
  const double c = std::min(distance + 0.5, half) - std::max(distance - 0.5, -half);
  return c < 0 ? 0 : c > 1 ? 1 : c;
}

/// Covers the pixels of one tile that lie in front of `keys`, one mark after the other. Overlaps of one group at about the same depth count
/// once.
class MarkTile {
 public:
  MarkTile(const PixelBox& box, const Projection& projection, const uint64_t* keys) : box_(box), projection_(projection), keys_(keys) {}
  void draw(const MarkRecord& m, std::vector<Cover>& out);

 private:
  void add(const Cover& c, uint32_t group, double joint, std::vector<Cover>& out);
  struct Last {
    uint32_t item = 0xFFFFFFFFu, group = 0, at = 0;
  };
  PixelBox box_;
  const Projection& projection_;
  const uint64_t* keys_;
  std::vector<Last> last_, last_halo_;
};

/// Colours of the covers of lines and dots. `under`: linear RGBA of the opaque pixel behind.
void color_mark(const PreparedItem& item, const std::vector<Lamp>& lights, const Projection& projection, const float* under, Cover& cover);

}  // namespace sg::raster
