// SPDX-License-Identifier: Apache-2.0
// One cell and a plane: where its edges cross, and how the crossings join to polygons.
#pragma once
#include <algorithm>
#include <functional>
#include <vector>

#include "base/vec.h"
#include "data/cells/cell_topology.h"
#include "filter/mesh/surface_builder.h"

namespace sg::detail {

/// Name of a crossing: the two ends of its edge, or one point twice when the plane passes through it.
inline int64_t crossing_key(uint32_t a, uint32_t b) { return int64_t(uint64_t(std::min(a, b)) << 32 | std::max(a, b)); }
inline uint32_t key_a(int64_t key) { return uint32_t(uint64_t(key) >> 32); }
inline uint32_t key_b(int64_t key) { return uint32_t(key); }

/// Signed distances of points from the plane and their positions, asked by id.
struct PlaneField {
  std::function<double(size_t)> distance;
  std::function<Vec3(size_t)> position;
  Vec3 normal;                               ///< of the polygons
  std::function<Vec3(Vec3)> normal_at = {};  ///< the same for a shape that is not flat; its polygons become triangles
  /// A crossing on the edge of a key, the same for each cell that asks: share of the second end, and place.
  double share(int64_t key) const;
  Vec3 place(int64_t key) const;
};

/// Appends what the plane makes of a cell to a chunk whose point ids are crossing keys. One per thread.
class PlaneCutter {
 public:
  PlaneCutter(const PlaneField& plane, SurfaceChunk& out) : plane_(plane), out_(out) {}
  /// Faces as lists of point ids; `distance` of each id is asked from the plane.
  void begin_solid() { segments_.clear(); }
  void add_face(std::span<const int64_t> ids);
  void end_solid(int64_t cell);
  /// A flat cell: lines between its crossings.
  void cut_flat(std::span<const int64_t> outline, int64_t cell);
  /// A chain of segments: vertices.
  void cut_curve(std::span<const int64_t> ids, int64_t cell);

 private:
  void cross(std::span<const int64_t> ids);
  void pair_up();
  int64_t settled(int64_t key) const;
  void close_loop(int64_t cell);

  const PlaneField& plane_;
  SurfaceChunk& out_;
  std::vector<double> d_;
  std::vector<int64_t> keys_;                          // crossings of the face at hand, in order around it
  std::vector<std::pair<int64_t, int64_t>> segments_;  // of the cell at hand
  std::vector<int64_t> loop_;
  std::vector<uint8_t> done_;
};

}  // namespace sg::detail
