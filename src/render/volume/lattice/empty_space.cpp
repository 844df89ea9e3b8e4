// SPDX-License-Identifier: Apache-2.0
#include "render/volume/lattice/empty_space.h"

#include <bit>

#include "base/parallel.h"

namespace sg::volume {

namespace {

constexpr int farthest = 63;

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

}  // namespace

std::vector<uint8_t> distance_to_drawn(const MinMaxBricks& bricks, const Transfer& transfer, bool& any_empty) {
  Bits reached(bricks.dims), flat(bricks.dims), newly(bricks.dims);
  const size_t rows = reached.ny * reached.nz;
  std::vector<uint8_t> distance(bricks.size() + 3, uint8_t(farthest));
  const auto mark = [&](size_t row, const uint64_t* bits, int level) {
    for (size_t w = 0; w < reached.words; ++w)
      for (uint64_t rest = bits[w]; rest; rest &= rest - 1)
        distance[row * reached.nx + 64 * w + size_t(std::countr_zero(rest))] = uint8_t(level);
  };
  size_t left = parallel_reduce(
      rows, rows_at_once, size_t(0),
      [&](size_t begin, size_t end) {
        size_t empty = 0;
        for (size_t r = begin; r < end; ++r) {
          uint64_t* to = &reached.bits[r * reached.words];
          for (size_t x = 0; x < reached.nx; ++x) {
            const MinMaxBricks::Range& range = bricks.ranges[r * reached.nx + x];
            if (transfer.clear(range.lo, range.hi)) ++empty;
            else to[x / 64] |= uint64_t(1) << x % 64;
          }
          mark(r, to, 0);
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
            mark(r, more, level);
          }
          return found;
        },
        [](size_t a, size_t b) { return a + b; });
  }
  return distance;
}

}  // namespace sg::volume
