// SPDX-License-Identifier: Apache-2.0
#include "render/volume/lattice/empty_space.h"

#include <bit>

#include "base/error.h"
#include "base/parallel.h"
#include "index/brick_row.h"
#include "render/volume/lattice/empty_space_simd.h"

namespace sg::volume {

namespace {

constexpr int farthest = 15;

/// One bit per brick, rows along x begin at words.
struct Bits {
  size_t nx, ny, nz, words;
  std::vector<uint64_t> bits;

  explicit Bits(const std::array<size_t, 3>& dims) : nx(dims[0]), ny(dims[1]), nz(dims[2]), words((nx + 63) / 64), bits(words * ny * nz) {}
  uint64_t* row(size_t y, size_t z) { return &bits[words * (y + ny * z)]; }
  const uint64_t* row(size_t y, size_t z) const { return &bits[words * (y + ny * z)]; }
  uint64_t used(size_t word) const { return word + 1 < words || nx % 64 == 0 ? ~uint64_t(0) : (uint64_t(1) << nx % 64) - 1; }
};

constexpr size_t rows_at_once = 256;

/// A row or'ed with its neighbours along x and y.
void widen_row(const Bits& in, size_t y, size_t z, Bits& out) {
  uint64_t* to = out.row(y, z);
  for (size_t w = 0; w < in.words; ++w) {
    uint64_t sum = 0;
    for (size_t j = y > 0 ? y - 1 : 0; j <= std::min(y + 1, in.ny - 1); ++j) {
      const uint64_t* from = in.row(j, z);
      sum |= from[w] | from[w] << 1 | from[w] >> 1;
      if (w > 0) sum |= from[w - 1] >> 63;
      if (w + 1 < in.words) sum |= from[w + 1] << 63;
    }
    to[w] = sum & in.used(w);
  }
}

/// Entries of a transfer function on a linear axis that draw something, counted.
std::vector<uint32_t> count_drawn(const Transfer& transfer) {
  const int count = transfer.linear_table().count;
  std::vector<uint32_t> before(size_t(count) + 3);
  for (int i = 0; i <= count + 1; ++i) before[size_t(i) + 1] = before[size_t(i)] + transfer.draws(i);
  return before;
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
  Bits reached(bricks.dims), flat(bricks.dims), newly(bricks.dims);
  const size_t rows = reached.ny * reached.nz, nx = reached.nx;
  Distances distance;
  distance.resize(bricks.size() + 3);
  std::fill(distance.end() - 3, distance.end(), uint8_t(farthest));
  std::vector<uint32_t> before;
  DrawnEntries entries{};
  if (transfer.linear()) {
    before = count_drawn(transfer);
    const LinearTable t = transfer.linear_table();
    entries = {t.first, t.per_axis, float(t.count + 1), before.data()};
  }
  const auto count_set = [&](size_t row, const Bits& bits) {
    size_t n = 0;
    for (size_t w = 0; w < bits.words; ++w) n += size_t(std::popcount(bits.bits[row * bits.words + w]));
    return n;
  };
  size_t left = parallel_reduce(
      rows, rows_at_once, size_t(0),
      [&](size_t begin, size_t end) {
        size_t empty = 0;
        for (size_t r = begin; r < end; ++r) {
          const MinMaxBricks::Range* range = &bricks.ranges[r * nx];
          uint64_t* bits = &reached.bits[r * reached.words];
          uint8_t* to = &distance[r * nx];
          if (!before.empty()) find_drawn(range, nx, entries, uint8_t(farthest), bits, to);
          else
            for (size_t x = 0; x < nx; ++x) {
              const bool drawn = !transfer.clear(range[x].lo, range[x].hi);
              bits[x / 64] |= uint64_t(drawn) << x % 64, to[x] = drawn ? uint8_t(0) : uint8_t(farthest);
            }
          empty += nx - count_set(r, reached);
        }
        return empty;
      },
      [](size_t a, size_t b) { return a + b; });
  any_empty = left > 0;
  // Level by level the bricks around those that were reached, until all are.
  for (int level = 1; level < farthest && left > 0 && left < bricks.size(); ++level) {
    parallel_for(rows, rows_at_once, [&](size_t begin, size_t end) {
      for (size_t r = begin; r < end; ++r) widen_row(reached, r % reached.ny, r / reached.ny, flat);
    });
    left -= parallel_reduce(
        rows, rows_at_once, size_t(0),
        [&](size_t begin, size_t end) {
          size_t found = 0;
          for (size_t r = begin; r < end; ++r) {
            const size_t y = r % reached.ny, z = r / reached.ny;
            uint64_t *old = reached.row(y, z), *more = newly.row(y, z);
            for (size_t w = 0; w < reached.words; ++w) {
              uint64_t sum = flat.row(y, z)[w];
              if (z > 0) sum |= flat.row(y, z - 1)[w];
              if (z + 1 < reached.nz) sum |= flat.row(y, z + 1)[w];
              more[w] = sum & ~old[w], old[w] = sum;
              found += size_t(std::popcount(more[w]));
            }
            write_level(more, nx, uint8_t(level), &distance[r * nx]);
          }
          return found;
        },
        [](size_t a, size_t b) { return a + b; });
  }
  return distance;
}

}  // namespace sg::volume
