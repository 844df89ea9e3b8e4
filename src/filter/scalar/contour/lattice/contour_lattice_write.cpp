// SPDX-License-Identifier: Apache-2.0
// The second pass of contours on lattices: triangles and lines, row by row, where the first pass (contour_lattice.cpp) made room for them.
#include <bit>

#include "base/parallel.h"
#include "filter/scalar/contour/lattice/contour_lattice_rows.h"

namespace sg::contouring {

// Writes the surface of one value behind those that are there.
Piece LatticeContour::generate(const Cuts& cuts, Room& room) const {
  const size_t ny = frame_.dims[1], rows = cuts.rows.size(), points = cuts.vertices + cuts.inner;
  const int corners = frame_.axes;  // of a line or triangle
  Piece piece;
  piece.first_point = room.points_done;
  piece.stride = frame_.stride;
  piece.xyz = room.xyz.slice(room.points_done, room.points_done + points);
  if (room.normals_out) piece.normals = room.normals.slice(room.points_done, room.points_done + points);
  piece.points = {room.edge_points.bytes, job_.edges ? room.edge_points.data + room.edges_done : nullptr, cuts.vertices};
  piece.inner = {room.inner_points.bytes, room.inner_points.data + room.inner_done, cuts.inner};
  (corners == 3 ? piece.triangles : piece.lines) =
      room.ids.slice(room.cells_done * size_t(corners), (room.cells_done + cuts.cells) * size_t(corners));
  int32_t* out = room.ids_out + room.cells_done * size_t(corners);
  uint32_t* from = job_.cells ? room.cell_numbers.data + room.cells_done : nullptr;
  if (job_.cells) (corners == 3 ? piece.triangle_cells : piece.line_cells) = {room.cell_numbers.bytes, from, cuts.cells};
  parallel_for(
      rows, std::max<size_t>(1, 512 / words_),
      [&](size_t begin, size_t end) {
        for (size_t r = begin; r < end; ++r) {
          const size_t first = cuts.rows[r].cell;
          if ((r + 1 < rows ? cuts.rows[r + 1].cell : cuts.cells) == first) continue;
          uint32_t* cells = from ? from + first : nullptr;
          InnerPoint* inner = piece.inner.data + cuts.rows[r].inner;
          if (simple()) simple_triangles_of_row(cuts, r % ny, r / ny, uint32_t(piece.first_point), out + 3 * first, cells, inner);
          else if (corners == 3) triangles_of_row(cuts, r % ny, r / ny, uint32_t(piece.first_point), out + 3 * first, cells, inner);
          else lines_of_row(cuts, r, uint32_t(piece.first_point), out + 2 * first, cells);
        }
      },
      &job_.context);
  make_vertices({frame_, job_.samples, cuts.value, job_.origin, words_, cuts.inside.data(), skip_.empty() ? nullptr : cuts.cut, cuts.rows,
                 room.xyz_out + 3 * room.points_done, room.normals_out ? room.normals_out + 3 * room.points_done : nullptr,
                 piece.points.data, job_.context, piece.inner.span(), cuts.vertices});
  room.points_done += points, room.edges_done += cuts.vertices, room.inner_done += cuts.inner, room.cells_done += cuts.cells;
  return piece;
}

// Where triangles of a row go.
struct LatticeContour::Writing {
  const LatticeContour& all;
  const Cuts& cuts;
  size_t first_point_of_row;  // its number on the lattice
  uint32_t first_cell, next_inner;
  InnerPoint* inner;

  Writing(const LatticeContour& a, const Cuts& c, size_t j, size_t k, uint32_t first_point, InnerPoint* to) : all(a), cuts(c), inner(to) {
    const size_t nx = a.frame_.dims[0], ny = a.frame_.dims[1], row = j + ny * k;
    first_point_of_row = row * nx;
    first_cell = uint32_t((nx - 1) * (j + (ny - 1) * k));
    next_inner = first_point + uint32_t(c.vertices + c.rows[row].inner);
  }

  void triangle(uint32_t a, uint32_t b, uint32_t c, size_t i, int32_t*& out, uint32_t*& cells) const {
    out[0] = int32_t(a);
    out[all.flip_ ? 2 : 1] = int32_t(b);
    out[all.flip_ ? 1 : 2] = int32_t(c);
    out += 3;
    if (cells) *cells++ = first_cell + uint32_t(i);
  }

  // A cell that the table cannot cut by itself; `list` has the numbers of its edges.
  void slow(size_t i, const uint32_t* list, int32_t*& out, uint32_t*& cells) {
    uint32_t edge[TrilinearCell::first_inner + 8];
    std::copy_n(list, TrilinearCell::first_inner, edge);
    const size_t p = first_point_of_row + i;
    const Slow slow(p, cuts.value, all.frame_, all.sample_, true);
    const TrilinearCell& cell = slow.cell;
    for (int n = 0; n < cell.inner_count; ++n) {
      const auto& u = cell.inner[size_t(n)];
      edge[TrilinearCell::first_inner + n] = next_inner++;
      *inner++ = {p, {float(u[0]), float(u[1]), float(u[2])}};
    }
    for (int t = 0; t < cell.triangle_count; ++t) {
      const auto& name = cell.triangles[size_t(t)];
      triangle(edge[name[0]], edge[name[1]], edge[name[2]], i, out, cells);
    }
  }
};

void LatticeContour::simple_triangles_of_row(const Cuts& cuts, size_t j, size_t k, uint32_t first_point, int32_t* out, uint32_t* cells,
                                             InnerPoint* inner) const {
  const size_t ny = frame_.dims[1], r = j + ny * k;
  Writing writing(*this, cuts, j, k, first_point, inner);
  const uint64_t* a = cuts.inside.data() + r * words_;
  const RowStart* near = &cuts.rows[r];
  const TriangleRow row{*tables_,
                        {{a, a + words_, a + ny * words_, a + (ny + 1) * words_}, words_, frame_.dims[0]},
                        near,
                        near + ny,
                        first_point,
                        out,
                        cells,
                        writing.first_cell,
                        &writing,
                        [](void* w, size_t i, const uint32_t* edges, int32_t*& to, uint32_t*& numbers) {
                          static_cast<Writing*>(w)->slow(i, edges, to, numbers);
                        }};
  write_triangles(row);
}

// The same where some cells are left out. Walks the crossed cells of a row with one counter per row of edges: an edge's number is the
// number of cut edges before it, and every cut edge of these rows belongs to a crossed cell that is visited.
void LatticeContour::triangles_of_row(const Cuts& cuts, size_t j, size_t k, uint32_t first_point, int32_t* out, uint32_t* cells,
                                      InnerPoint* inner) const {
  const size_t nx = frame_.dims[0], ny = frame_.dims[1];
  const size_t row[4] = {j + ny * k, j + 1 + ny * k, j + ny * (k + 1), j + 1 + ny * (k + 1)};
  Writing writing(*this, cuts, j, k, first_point, inner);
  uint32_t at[8];
  first_edges(&cuts.rows[row[0]], &cuts.rows[row[2]], first_point, at);
  for (size_t w = 0; w < words_; ++w) {
    Pair q[4];
    uint64_t any = 0, every = ~uint64_t(0);
    for (int s = 0; s < 4; ++s) {
      q[s] = Pair(&cuts.inside[row[s] * words_], w, words_);
      any |= q[s].m | q[s].s;
      every &= q[s].m & q[s].s;
    }
    uint64_t active = any & ~every & cell_bits(w, nx);
    if (!active) continue;
    const uint64_t skip = skip_[row[0] * words_ + w];
    uint64_t c[8];
    for (int s = 0; s < 4; ++s) c[s] = cuts.cut[0][row[s] * words_ + w];
    c[4] = cuts.cut[1][row[0] * words_ + w], c[5] = cuts.cut[1][row[2] * words_ + w];
    c[6] = cuts.cut[2][row[0] * words_ + w], c[7] = cuts.cut[2][row[1] * words_ + w];
    for (; active; active &= active - 1) {
      const int i = std::countr_zero(active);
      uint32_t step[8];
      for (int s = 0; s < 8; ++s) step[s] = uint32_t(c[s] >> i & 1);
      if (!(skip >> i & 1)) {
        uint32_t edge[TrilinearCell::first_inner];
        for (int s = 0; s < 4; ++s) edge[s] = at[s];
        for (int s = 4; s < 8; ++s) edge[2 * s - 4] = at[s], edge[2 * s - 3] = at[s] + step[s];
        const uint32_t pattern = q[0].corners(i) | q[1].corners(i) << 2 | q[2].corners(i) << 4 | q[3].corners(i) << 6;
        const size_t cell = 64 * w + size_t(i), n = tables_->triangles[pattern];
        if (n == CellTables::slow) [[unlikely]] {
          writing.slow(cell, edge, out, cells);
        } else {
          const uint8_t* e = tables_->edges[pattern];  // wound right already
          for (size_t t = 0; t < 3 * n; ++t) *out++ = int32_t(edge[e[t]]);
          if (cells) cells = std::fill_n(cells, n, writing.first_cell + uint32_t(cell));
        }
      }
      for (int s = 0; s < 8; ++s) at[s] += step[s];
    }
  }
}

void LatticeContour::lines_of_row(const Cuts& cuts, size_t j, uint32_t first_point, int32_t* out, uint32_t* cells) const {
  const size_t nx = frame_.dims[0];
  uint32_t at[3] = {first_point + uint32_t(cuts.rows[j].vertex), first_point + uint32_t(cuts.rows[j + 1].vertex),
                    first_point + uint32_t(cuts.rows[j].vertex) + cuts.rows[j].cut[0]};
  for (size_t w = 0; w < words_; ++w) {
    const Pair a(&cuts.inside[j * words_], w, words_), b(&cuts.inside[(j + 1) * words_], w, words_);
    const uint64_t skip = skip_.empty() ? 0 : skip_[j * words_ + w];
    uint64_t c[3] = {a.m ^ a.s, b.m ^ b.s, a.m ^ b.m};
    if (!skip_.empty()) c[0] = cuts.cut[0][j * words_ + w], c[1] = cuts.cut[0][(j + 1) * words_ + w], c[2] = cuts.cut[1][j * words_ + w];
    for (uint64_t active = ((a.m | a.s | b.m | b.s) & ~(a.m & a.s & b.m & b.s)) & cell_bits(w, nx); active; active &= active - 1) {
      const int i = std::countr_zero(active);
      const uint32_t step[3] = {uint32_t(c[0] >> i & 1), uint32_t(c[1] >> i & 1), uint32_t(c[2] >> i & 1)};
      const uint32_t edge[4] = {at[0], at[1], at[2], at[2] + step[2]};
      if (!(skip >> i & 1)) {
        const size_t p = j * nx + 64 * w + size_t(i);
        const Square s = square_of(a.corners(i) | b.corners(i) << 2, p, cuts.value, frame_, sample_);
        for (int l = 0; l < s.lines; ++l) {
          *out++ = int32_t(edge[s.edge[2 * l]]);
          *out++ = int32_t(edge[s.edge[2 * l + 1]]);
          if (cells) *cells++ = uint32_t(p - j);
        }
      }
      for (int s = 0; s < 3; ++s) at[s] += step[s];
    }
  }
}

}  // namespace sg::contouring
