// SPDX-License-Identifier: Apache-2.0
// Marching cubes and squares on lattices, by rows of bits. One bit per sample says inside or outside; cut edges and crossed cells
// are then exclusive ors of rows, 64 at a time, so that everything away from the surface costs next to nothing. Rows are counted,
// the counts are summed, and all rows are written at the same time, as in the flying edges of Schroeder, Maynard, Geveci 2015.
#include <bit>

#include "base/huge_allocator.h"
#include "base/parallel.h"
#include "filter/scalar/cell_cases.h"
#include "filter/scalar/contour_active.h"
#include "filter/scalar/contour_parts.h"
#include "filter/scalar/trilinear_cell.h"

namespace sg::contouring {

static ptrdiff_t corner_offset(int c, const LatticeFrame& f) { return (c & 1) + (c >> 1 & 1) * f.stride[1] + (c >> 2) * f.stride[2]; }

struct LatticeContour::Cuts {
  double value = 0;
  Plane<uint64_t> inside;
  Plane<uint64_t> cut[3];  ///< bits of cut edges, where cells are left out; otherwise they follow from `inside`
  std::vector<RowStart> rows;
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

// A cell that the table alone cannot cut.
struct LatticeContour::Slow {
  TrilinearCell cell;
  Slow(size_t p, double value, const LatticeFrame& frame, const Sample& f) {
    double v[8];
    for (int c = 0; c < 8; ++c) v[c] = f(size_t(ptrdiff_t(p) + corner_offset(c, frame))) - value;
    cut_trilinear(v, cell);
  }
};

namespace {

// One word of a row of bits, and the same shifted so that bit i is that of point i+1.
struct Pair {
  uint64_t m = 0, s = 0;
  Pair() = default;
  Pair(const uint64_t* row, size_t w, size_t words) : m(row[w]), s(row[w] >> 1 | (w + 1 < words ? row[w + 1] << 63 : 0)) {}
  uint32_t corners(int b) const { return uint32_t(m >> b & 1) | uint32_t(s >> b & 1) << 1; }
};

// Bits of the edges (and cells) along x that exist in word w: point i and i+1 < n.
uint64_t inner_bits(size_t w, size_t n) {
  const size_t from = 64 * w, last = n - 1;
  return from >= last ? 0 : last - from >= 64 ? ~uint64_t(0) : ~uint64_t(0) >> (64 - (last - from));
}

// std::popcount is a call without the instruction, which not every machine has.
constexpr uint64_t bit_count(uint64_t x) {
  x -= x >> 1 & 0x5555555555555555;
  x = (x & 0x3333333333333333) + (x >> 2 & 0x3333333333333333);
  return ((x + (x >> 4)) & 0x0F0F0F0F0F0F0F0F) * 0x0101010101010101 >> 56;
}

// Lines of a square: corners 0 (0,0), 1 (1,0), 2 (0,1), 3 (1,1); edges 0 below, 1 above (along x), 2 left, 3 right. Pairs of edges,
// the inside on the left. Patterns 6 and 9 have two ways: inside corners apart, then joined.
struct Square {
  uint8_t lines, edge[4];
};
constexpr Square squares[18] = {{0, {}},           {1, {0, 2}}, {1, {3, 0}}, {1, {3, 2}},       {1, {2, 1}},       {1, {0, 1}},
                                {2, {3, 0, 2, 1}}, {1, {3, 1}}, {1, {1, 3}}, {2, {0, 2, 1, 3}}, {1, {1, 0}},       {1, {1, 2}},
                                {1, {2, 3}},       {1, {0, 3}}, {1, {2, 0}}, {0, {}},           {2, {2, 0, 3, 1}}, {2, {0, 3, 1, 2}}};

Square square_of(uint32_t pattern, size_t p, double value, const LatticeFrame& frame, const Sample& f) {
  if (pattern != 6 && pattern != 9) return squares[pattern];
  const size_t up = size_t(frame.stride[1]);
  const bool joined = joined_inside(f(p) - value, f(p + 1) - value, f(p + up + 1) - value, f(p + up) - value);
  return squares[joined ? pattern == 6 ? 16 : 17 : pattern];
}

}  // namespace

LatticeContour::LatticeContour(const Job& job, std::shared_ptr<const LatticeIndex> index)
    : job_(job), index_(std::move(index)), lattice_(job.input.mesh()), frame_(lattice_.view()), sample_(job.samples) {
  words_ = (frame_.dims[0] + 63) / 64;
  flip_ = !frame_.right_handed();
  for (uint32_t p = 0; p < 256; ++p) {
    const auto t = lattice_cases().plain(p);
    count_[p] = job.trilinear && needs_trilinear(p) ? slow_pattern : uint8_t((t[1] - t[0]) / 3);
    first_[p] = uint16_t(t[0]);
  }
  const size_t nx = frame_.dims[0], rows = frame_.dims[1] * frame_.dims[2];
  if (const Array& ghost = job.input.point_ghost(); !ghost.empty()) {
    const auto g = ghost.view<uint8_t>();
    std::vector<uint64_t> bad(rows * words_);
    for (size_t r = 0; r < rows; ++r)
      for (size_t i = 0; i < nx; ++i) bad[r * words_ + i / 64] |= uint64_t((g[r * nx + i] & ghost_hidden_point) != 0) << (i % 64);
    skip_points(bad);
  }
  if (const Array& ghost = job.input.cell_ghost(); !ghost.empty()) {
    const auto g = ghost.view<uint8_t>();
    skip_.resize(rows * words_);
    const size_t cx = nx - 1, cy = frame_.dims[1] - 1;
    for (size_t c = 0; c < g.count; ++c) {
      if (!(g[c] & (ghost_duplicate | ghost_refined_cell | ghost_hidden_cell))) continue;
      const size_t i = c % cx, j = c / cx % cy, k = c / cx / cy;
      skip_[(j + frame_.dims[1] * k) * words_ + i / 64] |= uint64_t(1) << (i % 64);
    }
  }
}

// A cell is left out when one of its corners is bad.
void LatticeContour::skip_points(const std::vector<uint64_t>& bad) {
  const size_t ny = frame_.dims[1], nz = frame_.dims[2];
  skip_.resize(ny * nz * words_);
  for (size_t k = 0; k < nz; ++k)
    for (size_t j = 0; j < ny; ++j)
      for (size_t w = 0; w < words_; ++w) {
        uint64_t any = 0;
        for (size_t dk = 0; dk < 2; ++dk)
          for (size_t dj = 0; dj < 2; ++dj) {
            if (j + dj >= ny || k + dk >= nz) continue;
            const Pair p(bad.data() + (j + dj + ny * (k + dk)) * words_, w, words_);
            any |= p.m | p.s;
          }
        skip_[(j + ny * k) * words_ + w] |= any;
      }
}

// Several values share one pass over the samples (each needs a bit per sample meanwhile) and one block of memory for the results.
std::vector<Piece> LatticeContour::run(std::span<const double> values) {
  const size_t nx = frame_.dims[0], rows = frame_.dims[1] * frame_.dims[2];
  const size_t together = std::max<size_t>(8, (size_t(256) << 20) / (8 * rows * words_ + 1));
  std::vector<Piece> pieces;
  for (size_t begin = 0; begin < values.size(); begin += together) {
    const auto some = values.subspan(begin, std::min(together, values.size() - begin));
    std::vector<Cuts> cuts(some.size());
    std::vector<uint64_t*> bits;
    std::vector<std::optional<ActiveWords>> where(some.size());
    for (size_t i = 0; i < some.size(); ++i) {
      cuts[i].value = some[i];
      cuts[i].inside.resize(rows * words_);
      bits.push_back(cuts[i].inside.data());
    }
    bool nan = false;
    if (index_) {
      for (size_t i = 0; i < some.size(); ++i) {
        where[i].emplace(*index_, frame_.dims, some[i]);
        where[i]->classify(job_.samples, bits[i], words_, job_.context);
      }
      if (!index_->missing.empty() && !missing_known_) skip_points(index_->missing);
      missing_known_ = true;
    } else {
      nan = classify(job_.samples, nx, rows, some, bits, words_, job_.context);
    }
    if (nan && !missing_known_) {
      std::vector<uint64_t> bad(rows * words_);
      find_missing(job_.samples, nx, rows, bad.data(), words_, job_.context);
      skip_points(bad);
      missing_known_ = true;
    }
    Room room;
    for (size_t i = 0; i < cuts.size(); ++i) {
      Cuts& c = cuts[i];
      find_cuts(c, where[i] ? &*where[i] : nullptr);
      room.edges += c.vertices, room.inner += c.inner, room.cells += c.cells;
    }
    if (room.edges + room.inner > size_t(INT32_MAX))
      fail_usage("the surfaces have more than 2^31 points", "contour", "contour a part of the grid at a time, or ask for fewer values");
    room.allocate(job_, frame_.axes);
    for (Cuts& c : cuts) {
      pieces.push_back(generate(c, room));
      c = {};
    }
  }
  return pieces;
}

void LatticeContour::find_cuts(Cuts& cuts, const ActiveWords* where) const {
  const size_t ny = frame_.dims[1], nz = frame_.dims[2], rows = ny * nz;
  if (!skip_.empty())
    for (int a = 0; a < frame_.axes; ++a) cuts.cut[a].resize(rows * words_);
  cuts.rows.resize(rows);
  parallel_for(
      rows, std::max<size_t>(1, 512 / words_),
      [&](size_t begin, size_t end) {
        for (size_t r = begin; r < end; ++r)
          if (!where || where->row(r % ny, r / ny)) count_row(cuts, r % ny, r / ny);
      },
      &job_.context);
  for (RowStart& row : cuts.rows) {
    cuts.vertices += std::exchange(row.vertex, cuts.vertices);
    cuts.cells += std::exchange(row.cell, cuts.cells);
    cuts.inner += std::exchange(row.inner, cuts.inner);
  }
}

// An edge is cut when its ends differ and a good cell lies at it; a cell is crossed when its corners differ.
void LatticeContour::count_row(Cuts& cuts, size_t j, size_t k) const {
  const size_t nx = frame_.dims[0], ny = frame_.dims[1], nz = frame_.dims[2], r = j + ny * k;
  const uint64_t* inside = cuts.inside.data();
  const bool up = j + 1 < ny, back = k + 1 < nz;
  const bool solid = frame_.axes == 3;
  const bool cells = up && (back || !solid);
  RowStart& row = cuts.rows[r];
  // Good cells of the row (dj, dk) before this one, 0 outside the grid; `spread` adds those to the left, for edges across x.
  auto good = [&](size_t dj, size_t dk, size_t w, bool spread) -> uint64_t {
    if (j < dj || k < dk || j - dj + 1 >= ny || (solid && k - dk + 1 >= nz) || (!solid && dk)) return 0;
    const uint64_t* s = skip_.data() + (j - dj + ny * (k - dk)) * words_;
    const uint64_t here = ~s[w] & inner_bits(w, nx);
    return spread ? here | here << 1 | (w ? (~s[w - 1] & inner_bits(w - 1, nx)) >> 63 : 0) : here;
  };
  for (size_t w = 0; w < words_; ++w) {
    const Pair a(inside + r * words_, w, words_);
    const uint64_t inner = inner_bits(w, nx);
    const Pair b = up ? Pair(inside + (r + 1) * words_, w, words_) : a;
    const Pair c = back ? Pair(inside + (r + ny) * words_, w, words_) : a;
    uint64_t cut[3] = {(a.m ^ a.s) & inner, a.m ^ b.m, a.m ^ c.m};
    if (!skip_.empty()) {
      cut[0] &= good(0, 0, w, false) | good(1, 0, w, false) | good(0, 1, w, false) | good(1, 1, w, false);
      cut[1] &= good(0, 0, w, true) | good(0, 1, w, true);
      cut[2] &= good(0, 0, w, true) | good(1, 0, w, true);
    }
    for (int l = 0; l < frame_.axes; ++l) {
      if (!skip_.empty()) cuts.cut[l][r * words_ + w] = cut[l];
      if (!cut[l]) continue;
      const uint32_t n = uint32_t(bit_count(cut[l]));
      row.cut[l] += n;
      row.vertex += n;
    }
    if (!cells) continue;
    const Pair d = back ? Pair(inside + (r + ny + 1) * words_, w, words_) : b;
    uint64_t active = ((a.m | a.s | b.m | b.s | c.m | c.s | d.m | d.s) & ~(a.m & a.s & b.m & b.s & c.m & c.s & d.m & d.s)) & inner;
    if (!skip_.empty()) active &= ~skip_[r * words_ + w];
    for (; active; active &= active - 1) {
      const int i = std::countr_zero(active);
      const uint32_t low = a.corners(i) | b.corners(i) << 2;
      const size_t p = r * nx + 64 * w + size_t(i);
      if (!solid) {
        row.cell += square_of(low, p, cuts.value, frame_, sample_).lines;
        continue;
      }
      const uint32_t pattern = low | c.corners(i) << 4 | d.corners(i) << 6;
      if (count_[pattern] != slow_pattern) [[likely]] {
        row.cell += count_[pattern];
        continue;
      }
      const Slow slow(p, cuts.value, frame_, sample_);
      row.cell += size_t(slow.cell.triangle_count);
      row.inner += size_t(slow.cell.inner_count);
    }
  }
}

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
          if (corners == 3)
            triangles_of_row(cuts, r % ny, r / ny, uint32_t(piece.first_point), out + 3 * first, cells,
                             piece.inner.data + cuts.rows[r].inner);
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

// Walks the crossed cells of a row with one counter per row of edges: an edge's number is the number of cut edges before it, and
// every cut edge of these rows belongs to a crossed cell that is visited.
void LatticeContour::triangles_of_row(const Cuts& cuts, size_t j, size_t k, uint32_t first_point, int32_t* out, uint32_t* cells,
                                      InnerPoint* inner) const {
  const size_t nx = frame_.dims[0], ny = frame_.dims[1];
  const size_t row[4] = {j + ny * k, j + 1 + ny * k, j + ny * (k + 1), j + 1 + ny * (k + 1)};
  const uint8_t* all = lattice_cases().triangle_edges();
  const size_t cell_row = (nx - 1) * (j + (ny - 1) * k);
  auto start = [&](size_t r, int axis) {
    const RowStart& s = cuts.rows[r];
    return first_point + uint32_t(s.vertex) + (axis > 0 ? s.cut[0] : 0) + (axis > 1 ? s.cut[1] : 0);
  };
  uint32_t at[8] = {start(row[0], 0), start(row[1], 0), start(row[2], 0), start(row[3], 0),
                    start(row[0], 1), start(row[2], 1), start(row[0], 2), start(row[1], 2)};
  const bool stored = !skip_.empty();
  uint32_t next_inner = first_point + uint32_t(cuts.vertices + cuts.rows[row[0]].inner);
  const int second = flip_ ? 2 : 1, third = flip_ ? 1 : 2;
  for (size_t w = 0; w < words_; ++w) {
    Pair q[4];
    uint64_t any = 0, every = ~uint64_t(0);
    for (int s = 0; s < 4; ++s) {
      q[s] = Pair(&cuts.inside[row[s] * words_], w, words_);
      any |= q[s].m | q[s].s;
      every &= q[s].m & q[s].s;
    }
    uint64_t active = any & ~every & inner_bits(w, nx);
    if (!active) continue;
    const uint64_t skip = skip_.empty() ? 0 : skip_[row[0] * words_ + w];
    uint64_t c[8];
    if (stored) {
      for (int s = 0; s < 4; ++s) c[s] = cuts.cut[0][row[s] * words_ + w];
      c[4] = cuts.cut[1][row[0] * words_ + w], c[5] = cuts.cut[1][row[2] * words_ + w];
      c[6] = cuts.cut[2][row[0] * words_ + w], c[7] = cuts.cut[2][row[1] * words_ + w];
    } else {
      for (int s = 0; s < 4; ++s) c[s] = q[s].m ^ q[s].s;
      c[4] = q[0].m ^ q[1].m, c[5] = q[2].m ^ q[3].m, c[6] = q[0].m ^ q[2].m, c[7] = q[1].m ^ q[3].m;
    }
    for (; active; active &= active - 1) {
      const int i = std::countr_zero(active);
      uint32_t step[8], edge[TrilinearCell::first_inner + 8];
      for (int s = 0; s < 8; ++s) step[s] = uint32_t(c[s] >> i & 1);
      if (!(skip >> i & 1)) {
        for (int s = 0; s < 4; ++s) edge[s] = at[s];
        for (int s = 4; s < 8; ++s) edge[2 * s - 4] = at[s], edge[2 * s - 3] = at[s] + step[s];
        const uint32_t pattern = q[0].corners(i) | q[1].corners(i) << 2 | q[2].corners(i) << 4 | q[3].corners(i) << 6;
        auto triangle = [&](uint32_t a, uint32_t b, uint32_t c) {
          out[0] = int32_t(a);
          out[second] = int32_t(b);
          out[third] = int32_t(c);
          out += 3;
          if (cells) *cells++ = uint32_t(cell_row + 64 * w + size_t(i));
        };
        if (count_[pattern] == slow_pattern) [[unlikely]] {
          const size_t p = row[0] * nx + 64 * w + size_t(i);
          const Slow slow(p, cuts.value, frame_, sample_);
          const TrilinearCell& cut_cell = slow.cell;
          for (int n = 0; n < cut_cell.inner_count; ++n) {
            const auto& u = cut_cell.inner[size_t(n)];
            edge[TrilinearCell::first_inner + n] = next_inner++;
            *inner++ = {p, {float(u[0]), float(u[1]), float(u[2])}};
          }
          for (int t = 0; t < cut_cell.triangle_count; ++t) {
            const auto& name = cut_cell.triangles[size_t(t)];
            triangle(edge[name[0]], edge[name[1]], edge[name[2]]);
          }
        } else {
          const uint8_t* e = all + first_[pattern];
          for (uint32_t t = count_[pattern]; t > 0; --t, e += 3) triangle(edge[e[0]], edge[e[1]], edge[e[2]]);
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
    for (uint64_t active = ((a.m | a.s | b.m | b.s) & ~(a.m & a.s & b.m & b.s)) & inner_bits(w, nx); active; active &= active - 1) {
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
