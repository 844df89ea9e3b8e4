// SPDX-License-Identifier: Apache-2.0
// Marching cubes and squares on lattices, by rows of bits. One bit per sample: inside or outside; cut edges and crossed cells
// are then exclusive ors of rows, 64 at a time, so that everything away from the surface costs next to nothing. Rows are counted,
// the counts are summed, and all rows are written at the same time, as in the flying edges of Schroeder, Maynard, Geveci 2015.
// contour_lattice_write.cpp writes them.
#include <bit>

#include "base/parallel.h"
#include "filter/scalar/contour/contour_active.h"
#include "filter/scalar/contour/lattice/contour_lattice_rows.h"

namespace sg::contouring {

LatticeContour::LatticeContour(const Job& job, std::shared_ptr<const LatticeIndex> index)
    : job_(job), index_(std::move(index)), lattice_(job.input.mesh()), frame_(lattice_.view()), sample_(job.samples) {
  words_ = (frame_.dims[0] + 63) / 64;
  flip_ = !frame_.right_handed();
  tables_ = &CellTables::of(job.trilinear, flip_);
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
    std::vector<RowsOut> out;
    for (size_t i = 0; i < some.size(); ++i) {
      cuts[i].value = some[i];
      cuts[i].inside.resize(rows * words_ + 1);  // see RowBits
      cuts[i].inside.back() = 0;
      cuts[i].state.resize(rows);
      out.push_back({cuts[i].inside.data(), cuts[i].state.data()});
    }
    bool nan = false;
    if (index_) {
      for (size_t i = 0; i < some.size(); ++i)
        classify_known(job_.samples, nx, rows, index_->ranges, some[i], out[i], words_, job_.context);
      if (!index_->missing.empty() && !missing_known_) skip_points(index_->missing);
      missing_known_ = true;
    } else {
      nan = classify(job_.samples, nx, rows, some, out, words_, job_.context);
    }
    if (nan && !missing_known_) {
      std::vector<uint64_t> bad(rows * words_);
      find_missing(job_.samples, nx, rows, bad.data(), words_, job_.context);
      skip_points(bad);
      missing_known_ = true;
    }
    Room room;
    for (Cuts& c : cuts) {
      find_cuts(c);
      room.edges += c.vertices, room.inner += c.inner, room.cells += c.cells;
    }
    if (room.edges + room.inner > size_t(INT32_MAX))
      fail_usage("the surfaces have more than 2^31 points", "contour", "contour a part of the grid at a time, or use fewer values");
    room.allocate(job_, frame_.axes);
    for (Cuts& c : cuts) {
      pieces.push_back(generate(c, room));
      c = {};
    }
  }
  return pieces;
}

void LatticeContour::find_cuts(Cuts& cuts) const {
  const size_t ny = frame_.dims[1], nz = frame_.dims[2], rows = ny * nz;
  if (!skip_.empty())
    for (int a = 0; a < frame_.axes; ++a) cuts.cut[a].assign(rows * words_, 0);  // rows without a cut are left out
  cuts.rows.resize(rows);                                                        // not initialised
  // Places are sums of counts: within each chunk first, then those of the preceding chunks are added.
  const size_t grain = std::max<size_t>(1, 512 / words_);
  std::vector<RowStart> before((rows + grain - 1) / grain, RowStart{});
  auto sum_up = [](RowStart& place, RowStart& sum) {
    sum.vertex += std::exchange(place.vertex, sum.vertex);
    sum.cell += std::exchange(place.cell, sum.cell);
    sum.inner += std::exchange(place.inner, sum.inner);
  };
  parallel_for(
      rows, grain,
      [&](size_t begin, size_t end) {
        std::vector<uint64_t> odd(words_);
        RowStart& sum = before[begin / grain];
        for (size_t r = begin; r < end; ++r) {
          const size_t j = r % ny, k = r / ny;
          cuts.rows[r] = {};
          if (may_cut(cuts, j, k)) simple() ? count_simple_row(cuts, j, k, odd.data()) : count_row(cuts, j, k);
          sum_up(cuts.rows[r], sum);
        }
      },
      &job_.context);
  RowStart all{};
  for (RowStart& chunk : before) sum_up(chunk, all);
  cuts.vertices = all.vertex, cuts.cells = all.cell, cuts.inner = all.inner;
  parallel_for(
      rows, grain,
      [&](size_t begin, size_t end) {
        const RowStart& add = before[begin / grain];
        for (size_t r = begin; r < end; ++r)
          cuts.rows[r].vertex += add.vertex, cuts.rows[r].cell += add.cell, cuts.rows[r].inner += add.inner;
      },
      &job_.context);
}

// False when the row and those behind it hold one and the same bit.
bool LatticeContour::may_cut(const Cuts& cuts, size_t j, size_t k) const {
  const size_t ny = frame_.dims[1], r = j + ny * k;
  const RowState s = cuts.state[r];
  if (s == RowState::mixed) return true;
  const bool up = j + 1 < ny, back = k + 1 < frame_.dims[2];
  return (up && cuts.state[r + 1] != s) || (back && cuts.state[r + ny] != s) || (up && back && cuts.state[r + ny + 1] != s);
}

// Solids whose cells are all good: most by bits only.
void LatticeContour::count_simple_row(Cuts& cuts, size_t j, size_t k, uint64_t* odd) const {
  const size_t nx = frame_.dims[0], ny = frame_.dims[1], nz = frame_.dims[2], r = j + ny * k;
  const uint64_t* a = cuts.inside.data() + r * words_;
  const bool up = j + 1 < ny, back = k + 1 < nz;
  RowStart& row = cuts.rows[r];
  count_edges(a, up ? a + words_ : nullptr, back ? a + ny * words_ : nullptr, words_, nx, row.cut);
  row.vertex = size_t(row.cut[0]) + row.cut[1] + row.cut[2];
  if (!up || !back) return;
  const RowBits rows{{a, a + words_, a + ny * words_, a + (ny + 1) * words_}, words_, nx};
  bool any_odd = false;
  row.cell = count_triangles(rows, odd, any_odd);
  if (!any_odd) return;
  for (size_t w = 0; w < words_; ++w) {
    if (!odd[w]) continue;
    const Pair q[4] = {{rows.row[0], w, words_}, {rows.row[1], w, words_}, {rows.row[2], w, words_}, {rows.row[3], w, words_}};
    for (uint64_t m = odd[w]; m; m &= m - 1) {
      const int i = std::countr_zero(m);
      const uint32_t pattern = q[0].corners(i) | q[1].corners(i) << 2 | q[2].corners(i) << 4 | q[3].corners(i) << 6;
      count_cell(cuts, row, pattern, r * nx + 64 * w + size_t(i));
    }
  }
}

void LatticeContour::count_cell(const Cuts& cuts, RowStart& row, uint32_t pattern, size_t p) const {
  if (tables_->triangles[pattern] != CellTables::slow) {
    row.cell += tables_->triangles[pattern];
    return;
  }
  const Slow slow(p, cuts.value, frame_, sample_, false);
  row.cell += size_t(slow.cell.triangle_count);
  row.inner += size_t(slow.cell.inner_count);
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
    const uint64_t here = ~s[w] & cell_bits(w, nx);
    return spread ? here | here << 1 | (w ? (~s[w - 1] & cell_bits(w - 1, nx)) >> 63 : 0) : here;
  };
  for (size_t w = 0; w < words_; ++w) {
    const Pair a(inside + r * words_, w, words_);
    const uint64_t inner = cell_bits(w, nx);
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
      const uint32_t n = count_bits(cut[l]);
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
      count_cell(cuts, row, low | c.corners(i) << 4 | d.corners(i) << 6, p);
    }
  }
}

}  // namespace sg::contouring
