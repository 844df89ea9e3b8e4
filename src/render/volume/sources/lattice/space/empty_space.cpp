// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/lattice/space/empty_space.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "index/brick_row.h"
#include "render/volume/sources/lattice/space/empty_space_simd.h"

namespace sg::volume {

namespace {

static_assert(farthest_told == (1 << distance_planes) - 1);
constexpr size_t rows_at_once = 256, words_at_once = 512 * widen_words;

/// One bit per brick. Behind each row at least one bit is zero, between two layers a row, and around them all whatever is near.
struct BitBricks {
  size_t rows, layers, row, layer, words, pad;

  explicit BitBricks(const std::array<size_t, 3>& dims) : rows(dims[1]), layers(dims[2]), row(dims[0] / 64 + 1), layer(row * (rows + 1)) {
    words = (layer * layers + widen_words - 1) / widen_words * widen_words;
    pad = layer + row + 2 * widen_words;
  }
  /// The first word of row r, counted over all layers.
  size_t at(size_t r) const { return r / rows * layer + r % rows * row; }
  std::vector<uint64_t> padded() const { return std::vector<uint64_t>(words + 2 * pad); }
};

/// The entries of a transfer function that draw something as runs, one entry longer to each side, for rounding errors.
DrawnRuns drawn_runs(const Transfer& transfer) {
  const LinearTable table = transfer.linear_table();
  struct Run {
    int from, to;
  };
  std::vector<Run> runs;
  for (int i = 0; i <= table.count + 1; ++i) {
    if (!transfer.draws(i)) continue;
    if (!runs.empty() && runs.back().to == i - 1) runs.back().to = i;
    else runs.push_back({i, i});
  }
  // Too many: those nearest to each other become one.
  if (runs.size() > size_t(DrawnRuns::most)) {
    std::vector<size_t> gaps(runs.size() - 1);
    for (size_t i = 0; i < gaps.size(); ++i) gaps[i] = i;
    std::stable_sort(gaps.begin(), gaps.end(),
                     [&](size_t a, size_t b) { return runs[a + 1].from - runs[a].to > runs[b + 1].from - runs[b].to; });
    gaps.resize(size_t(DrawnRuns::most) - 1);
    std::sort(gaps.begin(), gaps.end());
    std::vector<Run> fewer{{runs.front().from, 0}};
    for (const size_t g : gaps) fewer.back().to = runs[g].to, fewer.push_back({runs[g + 1].from, 0});
    fewer.back().to = runs.back().to;
    runs = fewer;
  }
  // Entry i has its values between i - 1 and i; the first and the last go on for ever.
  DrawnRuns r{table.first, table.per_axis, int(runs.size()), {}, {}};
  for (size_t k = 0; k < runs.size(); ++k) {
    r.from[k] = runs[k].from == 0 ? -HUGE_VALF : float(runs[k].from - 2);
    r.to[k] = runs[k].to == table.count + 1 ? HUGE_VALF : float(runs[k].to + 1);
  }
  return r;
}

}  // namespace

FineBricks fine_bricks(const Array& values, std::array<size_t, 3> dims) {
  if (values.components() != 1 || !values.packed() || values.count() != dims[0] * dims[1] * dims[2] || values.count() == 0)
    fail_internal("fine_bricks: the array does not fit the lattice");
  FineBricks r;
  for (size_t a = 0; a < 3; ++a) r.dims[a] = (std::max<size_t>(dims[a], 2) - 2) / FineBricks::edge + 1;
  r.ranges.resize(r.dims[0] * r.dims[1] * r.dims[2]);
  dispatch(values, [&](auto view) {
    using T = std::remove_cvref_t<decltype(view.data[0])>;
    parallel_for(r.dims[1] * r.dims[2], 8, [&](size_t begin, size_t end) {
      std::vector<T> lo, hi;
      for (size_t row = begin; row < end; ++row)
        brick_row(view.data, dims, (row % r.dims[1]) * FineBricks::edge, (row / r.dims[1]) * FineBricks::edge, lo, hi, FineBricks::edge,
                  &r.ranges[row * r.dims[0]], r.dims[0]);
    });
  });
  return r;
}

MinMaxBricks coarse_bricks(const FineBricks& fine) {
  MinMaxBricks r;
  for (size_t a = 0; a < 3; ++a) r.dims[a] = (fine.dims[a] + 1) / 2;
  r.ranges.assign(r.dims[0] * r.dims[1] * r.dims[2], {HUGE_VALF, -HUGE_VALF});
  for (size_t k = 0; k < fine.dims[2]; ++k)
    for (size_t j = 0; j < fine.dims[1]; ++j)
      for (size_t i = 0; i < fine.dims[0]; ++i) {
        const MinMaxBricks::Range from = fine.ranges[fine.id(i, j, k)];
        MinMaxBricks::Range& to = r.ranges[r.id(i / 2, j / 2, k / 2)];
        to.lo = std::min(to.lo, from.lo), to.hi = std::max(to.hi, from.hi);
      }
  return r;
}

Distances distance_to_drawn(const FineBricks& bricks, const Transfer& transfer, bool& any_empty) {
  const BitBricks lattice(bricks.dims);
  const size_t rows = lattice.rows * lattice.layers, nx = bricks.dims[0];
  std::vector<uint64_t> reached = lattice.padded(), more = lattice.padded(), used(lattice.words);
  const bool linear = transfer.linear();
  const DrawnRuns runs = linear ? drawn_runs(transfer) : DrawnRuns{};
  any_empty = parallel_reduce(
      rows, rows_at_once, false,
      [&](size_t begin, size_t end) {
        bool empty = false;
        for (size_t r = begin; r < end; ++r) {
          const MinMaxBricks::Range* range = &bricks.ranges[r * nx];
          uint64_t *bits = &reached[lattice.pad + lattice.at(r)], *own = &used[lattice.at(r)];
          if (linear) find_drawn(range, nx, runs, bits);
          else
            for (size_t x = 0; x < nx; ++x) bits[x / 64] |= uint64_t(!transfer.clear(range[x].lo, range[x].hi)) << x % 64;
          for (size_t w = 0; w < lattice.row; ++w) {
            const size_t left = nx - 64 * w;
            own[w] = left >= 64 ? ~uint64_t(0) : (uint64_t(1) << left) - 1;
            empty = empty || bits[w] != own[w];
          }
        }
        return empty;
      },
      [](bool a, bool b) { return a || b; });

  // Level by level the bricks around those that were reached, until all are. The level of a brick goes to planes, a bit each.
  std::vector<uint64_t> levels(distance_planes * lattice.words);
  for (int level = 1; level < farthest_told && any_empty; ++level) {
    uint64_t* planes[distance_planes];
    int count = 0;
    for (int k = 0; k < distance_planes; ++k)
      if (level >> k & 1) planes[count++] = &levels[size_t(k) * lattice.words];
    const bool any_new = parallel_reduce(
        lattice.words, words_at_once, false,
        [&](size_t begin, size_t end) {
          return widen({lattice.row, lattice.layer, used.data()}, &reached[lattice.pad], begin, end, &more[lattice.pad], planes, count);
        },
        [](bool a, bool b) { return a || b; });
    reached.swap(more);
    if (!any_new) break;
  }

  Distances distance;
  distance.resize(bricks.size() + 3);
  std::fill(distance.end() - 3, distance.end(), farthest_told);
  parallel_for(rows, rows_at_once, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) {
      const size_t at = lattice.at(r);
      const uint64_t* planes[distance_planes];
      for (size_t k = 0; k < distance_planes; ++k) planes[k] = &levels[k * lattice.words + at];
      write_distances(planes, &reached[lattice.pad + at], nx, &distance[r * nx]);
    }
  });
  return distance;
}

}  // namespace sg::volume
