// SPDX-License-Identifier: Apache-2.0
// What the two passes of LatticeContour share: rows of bits, cells that the table cannot cut, squares. Inside filter/scalar only.
#pragma once
#include "base/bits.h"
#include "base/huge_allocator.h"
#include "filter/scalar/contour/cells/cell_cases.h"
#include "filter/scalar/contour/cells/trilinear_cell.h"
#include "filter/scalar/contour/contour_parts.h"

namespace sg::contouring {

inline ptrdiff_t corner_offset(int c, const LatticeFrame& f) { return (c & 1) + (c >> 1 & 1) * f.stride[1] + (c >> 2) * f.stride[2]; }

struct LatticeContour::Cuts {
  double value = 0;
  Plane<uint64_t> inside;
  std::vector<RowState> state;  ///< of each row of `inside`
  Plane<uint64_t> cut[3];       ///< bits of cut edges, where cells are left out; otherwise they follow from `inside`
  Plane<RowStart> rows;
  size_t vertices = 0, cells = 0, inner = 0;
};

// Where the results of several values go, one behind the other.
struct LatticeContour::Room {
  size_t edges = 0, inner = 0, cells = 0;  // all together
  size_t points_done = 0, edges_done = 0, inner_done = 0, cells_done = 0;
  Array xyz, normals, ids;
  float *xyz_out = nullptr, *normals_out = nullptr;
  int32_t* ids_out = nullptr;
  Block<EdgePoint> edge_points;
  Block<InnerPoint> inner_points;
  Block<uint32_t> cell_numbers;

  void allocate(const Job& job, int corners) {
    xyz = Array::make<float>(edges + inner, 3, &xyz_out);
    if (job.normals && corners == 3) normals = Array::make<float>(edges + inner, 3, &normals_out);
    ids = Array::make<int32_t>(cells * size_t(corners), 1, &ids_out);
    if (job.edges) edge_points.allocate(edges);
    inner_points.allocate(inner);
    if (job.cells) cell_numbers.allocate(cells);
  }
};

// A cell that the table cannot cut by itself.
struct LatticeContour::Slow {
  TrilinearCell cell;
  Slow(size_t p, double value, const LatticeFrame& frame, const Sample& f, bool places) {
    double v[8];
    for (int c = 0; c < 8; ++c) v[c] = f(size_t(ptrdiff_t(p) + corner_offset(c, frame))) - value;
    cut_trilinear(v, cell, places);
  }
};

// One word of a row of bits, and the same shifted so that bit i is that of point i+1.
struct Pair {
  uint64_t m = 0, s = 0;
  Pair() = default;
  Pair(const uint64_t* row, size_t w, size_t words) : m(row[w]), s(row[w] >> 1 | (w + 1 < words ? row[w + 1] << 63 : 0)) {}
  uint32_t corners(int b) const { return uint32_t(m >> b & 1) | uint32_t(s >> b & 1) << 1; }
};

// Lines of a square: corners 0 (0,0), 1 (1,0), 2 (0,1), 3 (1,1); edges 0 below, 1 above (along x), 2 left, 3 right. Pairs of edges,
// the inside on the left. Patterns 6 and 9 have two ways: inside corners separated, then joined.
struct Square {
  uint8_t lines, edge[4];
};
inline constexpr Square squares[18] = {{0, {}},     {1, {0, 2}},       {1, {3, 0}},      {1, {3, 2}}, {1, {2, 1}},
                                       {1, {0, 1}}, {2, {3, 0, 2, 1}}, {1, {3, 1}},      {1, {1, 3}}, {2, {0, 2, 1, 3}},
                                       {1, {1, 0}}, {1, {1, 2}},       {1, {2, 3}},      {1, {0, 3}}, {1, {2, 0}},
                                       {0, {}},     {2, {2, 0, 3, 1}}, {2, {0, 3, 1, 2}}};

inline Square square_of(uint32_t pattern, size_t p, double value, const LatticeFrame& frame, const Sample& f) {
  if (pattern != 6 && pattern != 9) return squares[pattern];
  const size_t up = size_t(frame.stride[1]);
  const bool joined = joined_inside(f(p) - value, f(p + 1) - value, f(p + up + 1) - value, f(p + up) - value);
  return squares[joined ? pattern == 6 ? 16 : 17 : pattern];
}

}  // namespace sg::contouring
