// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour_active.h"

#include "base/parallel.h"
#include "data/memo.h"

namespace sg::contouring {

namespace {

// Eight cubes of eight samples each: bit b of the byte becomes byte b of a word of samples.
constexpr std::array<uint64_t, 256> spread = [] {
  std::array<uint64_t, 256> t{};
  for (uint64_t v = 0; v < 256; ++v)
    for (int b = 0; b < 8; ++b) t[v] |= (v >> b & 1) * (uint64_t(0xff) << (8 * b));
  return t;
}();

bool worth_it(const Job& job, const std::string& key, size_t values) { return job.input.memo().asked(key) > 0 || values > 3; }

template <class T, class Make>
std::shared_ptr<const T> remembered(const Job& job, const std::string& key, size_t values, Make&& make) {
  Memo& memo = job.input.memo();
  if (auto kept = memo.find<T>(key)) return kept;
  if (!worth_it(job, key, values)) return nullptr;
  T made = make();
  const size_t bytes = made.bytes();
  return memo.keep(key, std::move(made), bytes);
}

}  // namespace

std::shared_ptr<const LatticeIndex> lattice_index(const Job& job, const std::string& key) {
  return remembered<LatticeIndex>(job, "lattice index " + key, 1, [&] {
    const auto dims = lattice_dims(job.input.mesh());
    MinMaxBricks bricks = minmax_bricks(job.samples, dims);
    const size_t rows = dims[1] * dims[2], words = (dims[0] + 63) / 64;
    std::vector<uint64_t> missing;
    if (any_missing(job.samples, job.context)) {
      missing.resize(rows * words);
      find_missing(job.samples, dims[0], rows, missing.data(), words, job.context);
    }
    ActiveIndex cubes(minmax_octree(bricks));
    return LatticeIndex{std::move(cubes), std::move(bricks), std::move(missing)};
  });
}

std::shared_ptr<const CellActiveIndex> cell_index(const Job& job, const std::string& key, size_t values) {
  return remembered<CellActiveIndex>(job, "cell index " + key, values,
                                     [&] { return cell_active_index(job.input, job.samples, job.context); });
}

ActiveWords::ActiveWords(const LatticeIndex& index, std::array<size_t, 3> dims, double value)
    : index_(index), dims_(dims), value_(value), words_((index.bricks.dims[0] + 63) / 64) {
  const auto& n = index.bricks.dims;
  active_.resize(words_ * n[1] * n[2]);
  row_.resize(n[1] * n[2]);
  for (uint32_t id : index.cubes.active(value)) {
    const size_t row = id / n[0], i = id % n[0];
    active_[row * words_ + i / 64] |= uint64_t(1) << (i % 64);
    row_[row] = 1;
  }
}

// Points on the border of two rows of cubes belong to both.
ActiveWords::Touched ActiveWords::touched(size_t j, size_t k) const {
  constexpr size_t edge = MinMaxBricks::edge;
  const auto& n = index_.bricks.dims;
  const size_t y = std::min(j / edge, n[1] - 1), z = std::min(k / edge, n[2] - 1);
  const size_t y0 = j % edge == 0 && y > 0 ? y - 1 : y, z0 = k % edge == 0 && z > 0 ? z - 1 : z;
  Touched t;
  t.row[t.rows++] = y + n[1] * z;
  if (y0 != y) t.row[t.rows++] = y0 + n[1] * z;
  if (z0 != z) t.row[t.rows++] = y + n[1] * z0;
  if (y0 != y && z0 != z) t.row[t.rows++] = y0 + n[1] * z0;
  for (int r = 0; r < t.rows; ++r) t.none = t.none && !row_[t.row[r]];
  return t;
}

void ActiveWords::classify(const Array& samples, uint64_t* bits, size_t words, Context& context) const {
  const size_t nx = dims_[0], ny = dims_[1], cubes = index_.bricks.dims[0];
  const uint64_t last = nx % 64 ? ~uint64_t(0) >> (64 - nx % 64) : ~uint64_t(0);
  parallel_for(
      ny * dims_[2], std::max<size_t>(1, 65536 / nx),
      [&](size_t begin, size_t end) {
        std::vector<uint8_t> look(words);
        for (size_t r = begin; r < end; ++r) {
          const Touched t = touched(r % ny, r / ny);
          uint64_t* row = bits + r * words;
          if (!t.none)
            for (size_t w = 0; w < words; ++w) {
              // Samples 64w to 64w+63 lie in cubes 8w to 8w+7, and the first in cube 8w-1 too.
              uint64_t any = 0;
              for (int s = 0; s < t.rows; ++s) {
                const uint64_t* a = &active_[t.row[s] * words_];
                if (w / 8 < words_) any |= a[w / 8] >> (w % 8 * 8) & 0xff;
                if (w) any |= a[(8 * w - 1) / 64] >> ((8 * w - 1) % 64) & 1;
              }
              look[w] = any != 0;
            }
          const auto* ranges = &index_.bricks.ranges[t.row[0] * cubes];
          for (size_t w = 0; w < words; ++w) {
            if (!t.none && look[w]) continue;
            unsigned inside = 0;
            for (size_t b = 0; b < 8; ++b) {
              const auto& range = ranges[std::min(8 * w + b, cubes - 1)];
              inside |= unsigned(double(range.lo) >= value_ && !range.empty()) << b;
            }
            row[w] = spread[inside] & (w + 1 == words ? last : ~uint64_t(0));
          }
          if (!t.none) classify_words(samples, nx, r, value_, look.data(), bits, words);
        }
      },
      &context);
}

}  // namespace sg::contouring
