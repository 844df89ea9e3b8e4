// SPDX-License-Identifier: Apache-2.0
// The two passes over rows of bits that contours of solid lattices consist of. Inside filter/scalar only.
#pragma once
#include <cstddef>
#include <cstdint>

namespace sg::contouring {

/// Where the edges of a row of points are cut, and where their results go.
struct RowStart {
  size_t vertex, cell, inner;  ///< first of the row, after the prefix sum; preceding count
  uint32_t cut[3];             ///< cut edges along each axis; results lie in that order
};

/// What a pattern of corners (bit c: inside) means for the table way of cutting.
struct CellTables {
  static constexpr uint8_t slow = 255;
  uint8_t triangles[256];              ///< or slow: the table cannot cut it by itself
  alignas(16) uint8_t edges[256][16];  ///< the cell's edges, three per triangle in the order of writing
  uint16_t passed[256];                ///< bit per edge that moves on when the row's counters pass a cell; see triangles_of_row
  /// trilinear: ambiguous patterns are slow. flip: triangles are wound the other way.
  static const CellTables& of(bool trilinear, bool flip);
};

/// Four rows of bits around a row of cells: (j,k), (j+1,k), (j,k+1), (j+1,k+1). Four more bytes behind each can be read.
struct RowBits {
  const uint64_t* row[4];
  size_t words, points;  ///< of a row
};

/// Triangles of those cells that are no `odd` ones, and a bit for each odd one: cells with an ambiguous face or two isolated corners at the
/// ends of a diagonal. `any_odd` says whether there are such.
size_t count_triangles(const RowBits& rows, uint64_t* odd, bool& any_odd);

/// Cut edges of a row of points along x, y and z. Null: no such row.
void count_edges(const uint64_t* row, const uint64_t* up, const uint64_t* back, size_t words, size_t points, uint32_t cut[3]);

/// Numbers of the first cut edges: along x in the four rows, y in rows 0 and 2, z in rows 0 and 1.
inline void first_edges(const RowStart* near, const RowStart* back, uint32_t first_point, uint32_t* at) {
  const uint32_t x[4] = {first_point + uint32_t(near[0].vertex), first_point + uint32_t(near[1].vertex),
                         first_point + uint32_t(back[0].vertex), first_point + uint32_t(back[1].vertex)};
  for (int s = 0; s < 4; ++s) at[s] = x[s];
  at[4] = x[0] + near[0].cut[0], at[5] = x[2] + back[0].cut[0];
  at[6] = at[4] + near[0].cut[1], at[7] = x[1] + near[1].cut[0] + near[1].cut[1];
}

/// Writes the triangles of a row of cells, all of them good.
struct TriangleRow {
  const CellTables& tables;
  RowBits bits;
  const RowStart *near, *back;  ///< rows (j,k) and (j+1,k), rows (j,k+1) and (j+1,k+1)
  uint32_t first_point;         ///< what all numbers of points begin with
  int32_t* out;
  uint32_t* cells;  ///< null, or a number per triangle
  uint32_t first_cell;
  /// Cuts cell i with these numbers of its 12 edges; moves out and cells on.
  void* slow_job;
  void (*slow)(void* job, size_t i, const uint32_t* edges, int32_t*& out, uint32_t*& cells);
};
void write_triangles(const TriangleRow& row);

}  // namespace sg::contouring
