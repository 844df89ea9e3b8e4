// SPDX-License-Identifier: Apache-2.0
// What the parts of clip() share.
#pragma once
#include "base/context.h"
#include "data/dataset.h"
#include "filter/mesh/clip/clip_cell.h"
#include "filter/mesh/select/lattice_cells.h"

namespace sg::clipping {

/// A mesh, a value at each of its points, and what to keep.
struct Job {
  DatasetPtr in;
  Array numbers;  ///< packed f32 or f64, one a point
  Keep keep;
  CurvedFunction curved;  ///< of shapes that are not flat
  Context& context;
  Values values() const {
    if (numbers.type() == ElementType::f32) return {numbers.view<float>().data, nullptr};
    return {nullptr, numbers.view<double>().data};
  }
};

/// A value and the levels: its bits, and the meaning of the `or` of a cell's corner bits.
enum Side : uint8_t { side_kept = 1, side_low = 2, side_high = 4, side_missing = 8, side_on_low = 16, side_on_high = 32 };
inline uint8_t side_of(double value, const Keep& k) {
  if (value != value) return side_missing;
  if (k.between)
    return value < k.level    ? side_low
           : value > k.upper  ? side_high
           : value == k.level ? side_on_low
           : value == k.upper ? side_on_high
                              : side_kept;
  const double h = k.sign * (value - k.level);
  return h == 0 ? side_on_low : (h > 0) != k.outside ? side_kept : side_low;
}
enum class Fate : uint8_t { none, whole, cut };
inline Fate fate_of(uint8_t sides, bool outside) {
  if (sides & side_missing) return Fate::none;
  if (!(sides & (side_low | side_high))) return !(sides & side_kept) && outside ? Fate::none : Fate::whole;
  if (sides & side_kept) return Fate::cut;
  const bool low = sides & (side_low | side_on_low), high = sides & (side_high | side_on_high);
  return low && high ? Fate::cut : Fate::none;
}

/// Points of a lattice, a bit each, and their numbers.
struct LatticePoints {
  BitRows grid;
  Bits bits;
  BitRanks ranks;
};

/// The kept cells: first those that stay whole, in input order, then pieces. Points: kept ones, cut edges, inner vertices.
struct Build {
  Array connectivity, offsets, types;  ///< i32; i32, or empty when all have `fixed` points; u8, or empty when all are of `single`
  int fixed = 0;
  CellType single = CellType::empty;
  CellArray faces;
  Array polyhedron_faces;
  Plane<uint32_t> source;                     ///< input cell of each
  size_t kept = 0;                            ///< input points that are kept:
  Plane<uint32_t> points;                     ///< which, ...
  std::shared_ptr<const LatticePoints> rows;  ///< or bits of rows of a lattice
  Plane<uint64_t> cuts;                       ///< names of cut edges
  std::vector<size_t> inner_first{0};
  Plane<uint32_t> inner_points;
  Plane<double> inner_weights;
};

/// Unstructured meshes.
Build clip_lists(const Job& job);
/// Lattices of three axes, one level.
Build clip_lattice(const Job& job);
/// Points and fields.
DatasetPtr finish(const Job& job, Build build);

}  // namespace sg::clipping
