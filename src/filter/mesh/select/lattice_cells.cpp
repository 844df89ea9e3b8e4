// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/lattice_cells.h"

#include <cstring>

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

namespace {
constexpr size_t rows_per_chunk = 64;  // rows
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
  parallel_for(g.rows(), rows_per_chunk, [&](size_t begin, size_t end) {
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
                         size_t last_row, int32_t* __restrict connectivity, uint32_t* __restrict source) {
  for (size_t row = first_row; row < last_row; ++row) {
    const size_t j = row % g.ny, k = row / g.ny;
    if (j + 1 >= g.ny || k + 1 >= g.nz) continue;
    const size_t rows[4] = {g.row(j, k), g.row(j + 1, k), g.row(j, k + 1), g.row(j + 1, k + 1)};
    const size_t first_cell = (g.nx - 1) * (j + (g.ny - 1) * k);
    for (size_t w = 0; w < g.words; ++w)
      each_run(cells[row * g.words + w], [&](size_t bit, size_t n) {
        // Both ends of a kept cell are kept, so numbers go on by one along a run of cells.
        const size_t i = w * 64 + bit;
        int32_t first[8];
        for (size_t c = 0; c < 8; ++c) first[c] = int32_t(points(rows[kind.corner[c] >> 1], i)) + (kind.corner[c] & 1);
        for (size_t m = 0; m < n; ++m, connectivity += 8)
          for (size_t c = 0; c < 8; ++c) connectivity[c] = first[c] + int32_t(m);
        if (!source) return;
        for (size_t m = 0; m < n; ++m) source[m] = uint32_t(first_cell + i + m);
        source += n;
      });
  }
}

void copy_lattice_points(const Array& a, const BitRows& g, const BitRanks& points, std::byte* out) {
  const Array packed = a.made_packed();
  const size_t size = element_size(a.type()) * size_t(a.components());
  const std::byte* from = packed.raw();
  parallel_for(g.rows(), rows_per_chunk, [&](size_t begin, size_t end) {
    std::byte* to = out + size * points.before[begin * g.words];
    for (size_t row = begin; row < end; ++row)
      for (size_t w = 0; w < g.words; ++w)
        each_run((*points.bits)[row * g.words + w], [&](size_t bit, size_t n) {
          std::memcpy(to, from + size * (row * g.nx + w * 64 + bit), n * size);
          to += n * size;
        });
  });
}

void write_lattice_positions(const LatticeView& v, const BitRows& g, const BitRanks& points, double* xyz) {
  Plane<Vec3> along(v.mode == LatticeView::Mode::affine ? g.nx : 0);
  for (size_t i = 0; i < along.size(); ++i) along[i] = v.origin + v.step[0] * double(i);
  parallel_for(g.rows(), rows_per_chunk, [&](size_t begin, size_t end) {
    double* to = xyz + 3 * size_t(points.before[begin * g.words]);
    auto put = [&](Vec3 p) { to[0] = p.x, to[1] = p.y, to[2] = p.z, to += 3; };
    for (size_t row = begin; row < end; ++row) {
      const size_t j = row % g.ny, k = row / g.ny;
      const Vec3 y = v.step[1] * double(j), z = v.step[2] * double(k);
      for (size_t w = 0; w < g.words; ++w)
        each_run((*points.bits)[row * g.words + w], [&](size_t bit, size_t n) {
          const size_t first = w * 64 + bit, last = first + n;
          if (!along.empty())
            for (size_t i = first; i < last; ++i) put(along[i] + y + z);  // the sums of LatticeView::position()
          else
            for (size_t i = first; i < last; ++i) put(v.position(i, j, k));
        });
    }
  });
}

}  // namespace sg
