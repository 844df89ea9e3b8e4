// SPDX-License-Identifier: Apache-2.0
// Which cells of a mesh reach which layers of an axis-aligned grid: the work list of scan conversion.
#pragma once
#include <algorithm>
#include <vector>

#include "base/context.h"
#include "base/huge_allocator.h"
#include "data/lattice.h"
#include "index/cell_probe.h"

namespace sg {

/// Cells by slabs of `thickness` layers along z, ascending in each slab. A cell is in every slab that its box, grown by the tolerance of
/// CellProbe, reaches; hidden cells and those outside the grid are in none.
struct CellSlabs {
  size_t thickness = 1;
  std::vector<size_t> begin;  ///< slabs + 1
  Plane<uint32_t> cells;

  size_t size() const { return begin.size() - 1; }
};

/// What every thread needs of the mesh and the grid.
struct GridScan {
  DatasetPtr from;
  CellMap map;
  SimplexArrays simplices;
  double slack;
  Vec3 origin, spacing, inverse;  ///< point (i,j,k) = origin + spacing * (i,j,k); along an axis of one point spacing is 0 and inverse 1
  std::array<size_t, 3> dims;

  GridScan(const DatasetPtr& dataset, const LatticeView& grid);
  Vec3 to_grid(Vec3 x) const { return (x - origin) * inverse; }
  Vec3 point(size_t i, size_t j, size_t k) const { return origin + spacing * Vec3(double(i), double(j), double(k)); }
  CellProbe probe() const { return CellProbe(map, simplices, slack); }
  /// Box of a cell in grid coordinates, grown by its tolerance. `reader` is scratch.
  Box3 box(CellReader& reader, size_t cell) const;
  /// Points [lo, hi] of axis a in an interval; lo > hi: none, as for ends that are NaN.
  static void points_in(double from, double to, size_t n, ptrdiff_t& lo, ptrdiff_t& hi) {
    lo = from <= 0 ? 0 : from <= double(n) ? ptrdiff_t(std::ceil(from)) : ptrdiff_t(n);
    hi = to >= double(n - 1) ? ptrdiff_t(n) - 1 : to >= 0 ? ptrdiff_t(to) : -1;
  }
  /// As std::clamp, for an index: NaN, of which that makes an index anywhere, is `lo`.
  static double within(double v, double lo, double hi) { return v > lo ? std::min(v, hi) : lo; }
  /// `cell_layers`: layers are those of cells (between two points), not of points.
  CellSlabs slabs(size_t thickness, bool cell_layers, Context& context) const;
};

}  // namespace sg
