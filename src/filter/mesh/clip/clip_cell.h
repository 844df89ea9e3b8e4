// SPDX-License-Identifier: Apache-2.0
// One cell of any linear kind and one or two levels of a function: the pieces that are kept.
#pragma once
#include <algorithm>
#include <functional>
#include <map>
#include <span>
#include <unordered_map>
#include <vector>

#include "filter/mesh/clip/clip_cases.h"
#include "filter/mesh/clip/cut_numbers.h"

namespace sg::clipping {

/// Which values are kept: those of h = sign * (value - level) on one side of 0, or those between two levels.
struct Keep {
  double level = 0, sign = 1;
  bool outside = false;  ///< keeps h < 0 in place of h >= 0
  bool between = false;  ///< keeps level <= value <= upper; sign is 1 then
  double upper = 0;
  bool flat = false;  ///< the cut is a plane: it may have many-sided faces
};

/// A point that only this cell has: the mean of vertices, or a share of the way between two.
struct InnerVertex {
  std::vector<uint16_t> of;
  double t = -1;
};

/// Pieces over vertices: names (a, a) are mesh points, (a, b) with a < b cuts by the first level, a > b by the second one; from inner_name
/// on they are inner vertices.
struct CellPieces {
  static constexpr uint64_t inner_name = uint64_t(1) << 63;
  std::vector<uint64_t> names;
  std::vector<InnerVertex> inner;
  std::vector<CellType> types;
  std::vector<uint32_t> first{0};
  std::vector<uint16_t> vertices;
  std::vector<uint32_t> face_count;  ///< of each piece; 0 but for polyhedra
  std::vector<uint32_t> face_sizes;
  std::vector<uint16_t> face_vertices;

  size_t corners = 0;  ///< the first names are the cell's points

  bool is_inner(uint16_t v) const { return (names[v] & inner_name) != 0; }
  void clear();
  uint16_t vertex(uint64_t name);
  void end_piece(CellType type, uint32_t faces = 0);
};

/// Values of mesh points.
struct Values {
  const float* f32 = nullptr;
  const double* f64 = nullptr;
  double operator()(size_t i) const { return f32 ? double(f32[i]) : f64[i]; }
};

/// For functions that are not linear along edges: cuts are moved to where they are zero.
struct CurvedFunction {
  std::function<void(std::span<const Vec3>, std::span<double>)> evaluate;  ///< of places; safe from several threads
  /// Moves shares of the way from the first places to the second ones.
  std::function<void(std::span<const Vec3>, std::span<const Vec3>, std::span<double>)> refine;
  explicit operator bool() const { return bool(refine); }
  /// Where the cuts of the edges in `edges` (bits) of a cell will be, from the first corner of each on; `h`, as Keep has it: -1 times the
  /// function at the corners.
  void shares(const LinearTopology& cell, uint32_t edges, const double* h, const Vec3* places, double* out) const;
};

/// Where on the edge of a name a level crosses: the share of the way from the end with the smaller id.
inline double share_of(uint64_t name, const Values& values, const Keep& keep) {
  const uint64_t a = name >> 32, b = name & 0xffffffffu;
  const double level = a < b ? keep.level : keep.upper, low = values(std::min(a, b)) - level, high = values(std::max(a, b)) - level;
  return low / (low - high);
}

/// One per thread. Results stay valid until the next call.
class CellClipper {
 public:
  /// `position` is called for polygons that a level crosses more than twice, and for cells with pieces that could be inside out; without
  /// it the latter are taken for regular ones, as those of grids along the axes are. `rounding`: of coordinates; faces that are flat but
  /// for it count as flat.
  CellClipper(const Keep& keep, std::function<Vec3(size_t)> position, double rounding = 0)
      : keep_(keep), position_(std::move(position)), rounding_(rounding) {}
  /// Cuts will be moved along their edges: pieces must not be inside out there either.
  void follow(const CurvedFunction& curved, std::function<Vec3(size_t)> position) { curved_ = &curved, mesh_place_ = std::move(position); }
  /// A tetrahedron, pyramid, wedge, voxel or hexahedron. Values in the order of the ids.
  /// `folded`: an earlier result of folded() for this cell, or -1; it costs a look at each piece.
  const CellPieces& solid(const ClipTable& table, const int64_t* ids, const double* values, int folded = -1);
  bool folded() const { return folded_; }
  /// Was the last solid split because a level crosses a face that is not flat? Then its inner vertices may lie on faces, and its
  /// neighbours have the same ones (merge_shared).
  bool split() const { return split_; }
  /// Bit per face of four corners that a level crosses and that is not flat.
  static uint32_t bent_faces(const ClipTable& table, const int64_t* ids, const double* values, const Vec3* places, const Keep& keep,
                             double rounding);
  /// Points in order around.
  const CellPieces& polygon(std::span<const int64_t> ids, std::span<const double> values);
  /// Lines between consecutive points.
  const CellPieces& chain(std::span<const int64_t> ids, std::span<const double> values);
  /// Single points.
  const CellPieces& dots(std::span<const int64_t> ids, std::span<const double> values);
  /// Shares of the cell's points in an inner vertex of the last result; their sum is 1.
  void weights(uint16_t v, std::vector<double>& out) const;
  /// Faces as lists of places in `ids`.
  const CellPieces& polyhedron(std::span<const int64_t> ids, std::span<const double> values, std::vector<std::vector<uint16_t>> faces);

 private:
  using Ring = std::vector<uint16_t>;
  void begin(std::span<const int64_t> ids, std::span<const double> values);
  double height(uint16_t v, int level) const { return level == 0 ? keep_.sign * (value_[v] - keep_.level) : keep_.upper - value_[v]; }
  bool kept_outside(int level) const { return level == 0 && keep_.outside; }
  uint16_t add(uint64_t name, double value);
  uint16_t cut(uint16_t a, uint16_t b, int level);
  void add_region(const ClipTable& table, const uint16_t* corners, int level, bool last, int folded = -1);
  void clip_ring(const Ring& ring, int level, bool side, bool divided, std::vector<Ring>& out);
  std::vector<std::pair<size_t, size_t>> partners(const std::vector<uint16_t>& cuts) const;
  Vec3 place(uint16_t v) const;
  void add_weights(uint16_t v, double share, double* out) const;
  void add_ring(const Ring& ring);
  bool folds_when_moved(const ClipTable& table, const Sides& sides, const uint16_t* corners, const double* h) const;
  std::vector<Ring> cut_rings(const std::vector<Ring>& in, const std::vector<Ring>& out) const;
  std::vector<Ring> clip_faces(const std::vector<Ring>& faces, int level);

  void split_solid(const ClipTable& table, uint32_t bent);
  uint16_t mean_of(std::vector<uint16_t> of);
  std::vector<Ring> flat_faces(std::vector<Ring> faces) const;

  struct Waiting {
    CellType type;
    uint16_t v[8];
  };
  Keep keep_;
  std::function<Vec3(size_t)> position_;
  CellPieces out_;
  std::vector<double> value_;  // of each vertex
  std::vector<Waiting> waiting_;
  Sides own_;
  std::map<const ClipTable*, std::unordered_map<uint32_t, Sides>> zeros_;  // by pattern, corners that are zero, and joined faces
  bool folded_ = false, split_ = false;
  double rounding_ = 0;
  const CurvedFunction* curved_ = nullptr;
  std::function<Vec3(size_t)> mesh_place_;
};

}  // namespace sg::clipping
