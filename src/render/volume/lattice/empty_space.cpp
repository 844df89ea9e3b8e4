// SPDX-License-Identifier: Apache-2.0
#include "render/volume/lattice/empty_space.h"

#include <bit>

#include "base/error.h"
#include "base/parallel.h"
#include "index/brick_row.h"

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

/// Transfer::clear for many ranges: where the axis is linear, without branches; says "drawn" an entry too early.
class Clearness {
 public:
  explicit Clearness(const Transfer& transfer) : transfer_(transfer) {
    if (!transfer.linear()) return;
    const LinearTable t = transfer.linear_table();
    first_ = t.first, per_axis_ = t.per_axis, last_ = float(t.count + 1);
    drawn_before_.resize(size_t(t.count) + 3);
    for (int i = 0; i <= t.count + 1; ++i) drawn_before_[size_t(i) + 1] = uint16_t(drawn_before_[size_t(i)] + transfer.draws(i));
  }
  bool operator()(MinMaxBricks::Range r) const {
    if (drawn_before_.empty()) return transfer_.clear(r.lo, r.hi);
    // Entry of a value: int(axis) + 1, one more to each side for rounding errors.
    const float a = std::min(std::max((r.lo - first_) * per_axis_, 0.0f), last_),
                b = std::min(std::max((r.hi - first_) * per_axis_ + 2, 0.0f), last_);
    return !(r.lo <= r.hi) || drawn_before_[size_t(int(b)) + 1] == drawn_before_[size_t(int(a))];
  }

 private:
  const Transfer& transfer_;
  float first_ = 0, per_axis_ = 0, last_ = 0;
  std::vector<uint16_t> drawn_before_;
};

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

std::vector<uint8_t> distance_to_drawn(const FineBricks& bricks, const Transfer& transfer, bool& any_empty, const MinMaxBricks* coarse) {
  Bits reached(bricks.dims), flat(bricks.dims), newly(bricks.dims);
  const size_t rows = reached.ny * reached.nz;
  const Clearness clear(transfer);
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
        for (size_t r = begin; r < end; ++r)
          for (size_t w = 0; w < reached.words; ++w) {
            uint64_t drawn = 0;
            const size_t x0 = 64 * w, n = std::min<size_t>(64, reached.nx - x0);
            const MinMaxBricks::Range* range = &bricks.ranges[r * reached.nx + x0];
            const MinMaxBricks::Range* above =
                coarse ? &coarse->ranges[coarse->id(x0 / 2, r % reached.ny / 2, r / reached.ny / 2)] : nullptr;
            for (size_t x = 0; x < n; x += 2) {
              if (above && clear(above[x / 2])) continue;
              for (size_t i = x; i < std::min(x + 2, n); ++i)
                if (!clear(range[i])) drawn |= uint64_t(1) << i, distance[r * reached.nx + x0 + i] = 0;
            }
            reached.bits[r * reached.words + w] = drawn;
            empty += n - size_t(std::popcount(drawn));
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
