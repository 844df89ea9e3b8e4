// SPDX-License-Identifier: Apache-2.0
// Chosen cells of a lattice of three axes and the points they use, by bits: 64 cells at a time.
#pragma once
#include <array>
#include <bit>

#include "base/bits.h"
#include "base/huge_allocator.h"
#include "data/cells/cell_type.h"
#include "data/lattice.h"

namespace sg {

using Bits = Plane<uint64_t>;

/// How a lattice's cells are listed: voxels where they lie along the axes, else hexahedra that are not inside out.
struct LatticeCellKind {
  CellType type = CellType::voxel;
  std::array<uint8_t, 8> corner{};  ///< of each listed point: bit 0 along x, bit 1 along y, bit 2 along z
};
LatticeCellKind lattice_cell_kind(const Mesh& mesh);

/// Rows of bits: a row of points (or of cells, which have one fewer) has `words` words; row (j, k) is j + ny * k for both.
struct BitRows {
  size_t nx, ny, nz, words;
  explicit BitRows(std::array<size_t, 3> points) : nx(points[0]), ny(points[1]), nz(points[2]), words((points[0] + 63) / 64) {}
  size_t rows() const { return ny * nz; }
  size_t size() const { return rows() * words; }
  size_t row(size_t j, size_t k) const { return (j + ny * k) * words; }
  /// Bits of the cells of a row.
  uint64_t cell_mask(size_t w) const { return cell_bits(w, nx); }
};

/// 64 bytes that are 0 or 1 as bits.
inline uint64_t packed_bits(const uint8_t* bytes) {
  uint64_t r = 0;
  for (int i = 0; i < 8; ++i) {
    uint64_t v;
    __builtin_memcpy(&v, bytes + 8 * i, 8);
    r |= (v * 0x0102040810204080u >> 56) << (8 * i);
  }
  return r;
}

/// Calls f(first, count) for each run of set bits.
template <class F>
void each_run(uint64_t left, F&& f) {
  while (left) {
    const int first = std::countr_zero(left), count = std::countr_one(left >> first);
    f(size_t(first), size_t(count));
    if (first + count >= 64) return;
    left &= ~uint64_t(0) << (first + count);
  }
}

/// Points of the cells in `cells`, a bit each.
void used_points(const BitRows& g, const Bits& cells, Bits& points);

/// Numbers of set bits in order: of the bit at `i` of a row that starts at `row`.
struct BitRanks {
  const Bits* bits = nullptr;
  Plane<uint32_t> before;
  size_t total = 0;
  void number(const Bits& b);
  uint32_t operator()(size_t row, size_t i) const {
    const size_t w = row + (i >> 6);
    return before[w] + count_bits((*bits)[w] & ((uint64_t(1) << (i & 63)) - 1));
  }
  bool has(size_t row, size_t i) const { return (*bits)[row + (i >> 6)] >> (i & 63) & 1; }
};

/// Writes the connectivity (eight ids per cell) and, if requested, the cell numbers of the set bits of the cell rows [first, last).
void write_lattice_cells(const BitRows& g, const LatticeCellKind& kind, const Bits& cells, const BitRanks& points, size_t first_row,
                         size_t last_row, int32_t* connectivity, uint32_t* source);
/// Values, and positions, of the points whose bits are set, one after the other. Parallel.
void copy_lattice_points(const Array& a, const BitRows& g, const BitRanks& points, std::byte* out);
void write_lattice_positions(const LatticeView& v, const BitRows& g, const BitRanks& points, double* xyz);

}  // namespace sg
