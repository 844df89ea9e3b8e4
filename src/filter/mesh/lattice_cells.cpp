// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/lattice_cells.h"

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

namespace {
constexpr size_t grain = 64;  // rows
}

LatticeCellKind lattice_cell_kind(const Mesh& mesh) {
  bool box = !std::holds_alternative<CurvilinearGrid>(mesh), mirrored = false;
  if (auto* g = std::get_if<UniformGrid>(&mesh)) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) box = box && (r == c || g->direction.m[r][c] == 0);
    mirrored = !box && dot(cross(g->direction.column(0) * g->spacing[0], g->direction.column(1) * g->spacing[1]),
                           g->direction.column(2) * g->spacing[2]) < 0;
  }
  LatticeCellKind r;
  r.type = box ? CellType::voxel : CellType::hexahedron;
  for (uint8_t c = 0; c < 8; ++c) {
    const auto x = uint8_t((box ? c & 1 : (c ^ (c >> 1)) & 1) ^ int(mirrored));
    r.corner[c] = uint8_t(x | (c & 6));
  }
  return r;
}

void used_points(const BitRows& g, const Bits& cells, Bits& points) {
  points.resize(g.size());
  parallel_for(g.rows(), grain, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t j = row % g.ny, k = row / g.ny;
      uint64_t carry = 0;
      for (size_t w = 0; w < g.words; ++w) {
        uint64_t c = 0;
        for (size_t dk = 0; dk < 2; ++dk)
          for (size_t dj = 0; dj < 2; ++dj)
            if (j >= dj && k >= dk && j - dj + 1 < g.ny && k - dk + 1 < g.nz) c |= cells[g.row(j - dj, k - dk) + w];
        points[row * g.words + w] = c | c << 1 | carry;
        carry = c >> 63;
      }
    }
  });
}

void BitRanks::number(const Bits& b) {
  bits = &b;
  constexpr size_t chunk = 1 << 12;
  std::vector<size_t> start((b.size() + chunk - 1) / chunk);
  parallel_for(b.size(), chunk, [&](size_t begin, size_t end) {
    size_t n = 0;
    for (size_t w = begin; w < end; ++w) n += count_bits(b[w]);
    start[begin / chunk] = n;
  });
  total = exclusive_scan(start);
  if (total > size_t(INT32_MAX)) fail_usage("more than 2^31 points would be kept", {}, "take a part of the mesh first");
  before.resize(b.size());
  parallel_for(b.size(), chunk, [&](size_t begin, size_t end) {
    auto n = uint32_t(start[begin / chunk]);
    for (size_t w = begin; w < end; ++w) {
      before[w] = n;
      n += count_bits(b[w]);
    }
  });
}

void write_lattice_cells(const BitRows& g, const LatticeCellKind& kind, const Bits& cells, const BitRanks& points, size_t first_row,
                         size_t last_row, int32_t* connectivity, uint32_t* source) {
  for (size_t row = first_row; row < last_row; ++row) {
    const size_t j = row % g.ny, k = row / g.ny;
    if (j + 1 >= g.ny || k + 1 >= g.nz) continue;
    const size_t rows[4] = {g.row(j, k), g.row(j + 1, k), g.row(j, k + 1), g.row(j + 1, k + 1)};
    const size_t first_cell = (g.nx - 1) * (j + (g.ny - 1) * k);
    int32_t from[4] = {0, 0, 0, 0};
    for (size_t w = 0; w < g.words; ++w) {
      size_t expected = SIZE_MAX;
      for (uint64_t left = cells[row * g.words + w]; left; left &= left - 1) {
        const size_t i = w * 64 + size_t(std::countr_zero(left));
        // Both ends of a kept cell are kept, so numbers go on by one along a run of cells.
        for (int q = 0; q < 4; ++q) from[q] = i == expected ? from[q] + 1 : int32_t(points(rows[q], i));
        expected = i + 1;
        if (kind.type == CellType::voxel) {
          for (int q = 0; q < 4; ++q) connectivity[2 * q] = from[q], connectivity[2 * q + 1] = from[q] + 1;
        } else {
          for (int c = 0; c < 8; ++c) connectivity[c] = from[kind.corner[size_t(c)] >> 1] + (kind.corner[size_t(c)] & 1);
        }
        connectivity += 8;
        if (source) *source++ = uint32_t(first_cell + i);
      }
    }
  }
}

void write_lattice_points(const BitRows& g, const BitRanks& points, uint32_t* ids) {
  parallel_for(g.rows(), grain, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      uint32_t at = points.before[row * g.words];
      for (size_t w = 0; w < g.words; ++w)
        for (uint64_t left = (*points.bits)[row * g.words + w]; left; left &= left - 1)
          ids[at++] = uint32_t(row * g.nx + w * 64 + size_t(std::countr_zero(left)));
    }
  });
}

}  // namespace sg
