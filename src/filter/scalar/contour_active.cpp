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
    : dims_(dims), cubes_(index.bricks.dims), value_(value), words_((dims[0] + 63) / 64) {
  const auto& n = cubes_;
  const size_t rows = n[1] * n[2];
  wanted_.resize(rows * words_);
  row_.resize(rows);
  for (uint32_t id : index.cubes.active(value)) {
    const size_t row = id / n[0], i = id % n[0], w = i / 8;
    row_[row] = 1;
    // Samples 64w to 64w+63 lie in cubes 8w to 8w+7, and the first in cube 8w-1 too.
    wanted_[row * words_ + w] = 1;
    if (i % 8 == 7 && w + 1 < words_) wanted_[row * words_ + w + 1] = 1;
  }
  sure_.resize(rows * words_);
  const uint64_t last = dims[0] % 64 ? ~uint64_t(0) >> (64 - dims[0] % 64) : ~uint64_t(0);
  parallel_for(rows, 64, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      for (size_t w = 0; w < words_; ++w) {
        unsigned inside = 0;
        for (size_t b = 0; b < 8; ++b) {
          const auto& range = index.bricks.ranges[row * n[0] + std::min(8 * w + b, n[0] - 1)];
          inside |= unsigned(double(range.lo) >= value && !range.empty()) << b;
        }
        sure_[row * words_ + w] = spread[inside] & (w + 1 == words_ ? last : ~uint64_t(0));
      }
  });
}

void ActiveWords::look(size_t j, size_t k, uint8_t* wanted) const {
  const Near near = touched(j, k);
  std::fill_n(wanted, words_, 0);
  for (size_t y = near.y0; y <= near.y1; ++y)
    for (size_t z = near.z0; z <= near.z1; ++z) {
      const uint8_t* some = &wanted_[(y + cubes_[1] * z) * words_];
      for (size_t w = 0; w < words_; ++w) wanted[w] |= some[w];
    }
}

void ActiveWords::classify(const Array& samples, uint64_t* bits, Context& context) const {
  constexpr size_t edge = MinMaxBricks::edge;
  const size_t nx = dims_[0], ny = dims_[1];
  parallel_for(
      cubes_[1] * dims_[2], std::max<size_t>(1, 8192 / nx),
      [&](size_t begin, size_t end) {
        std::vector<uint8_t> wanted(words_);
        for (size_t n = begin; n < end; ++n) {
          const size_t y = n % cubes_[1], k = n / cubes_[1], z = touched(0, k).z1;
          const uint64_t* sure = &sure_[(y + cubes_[1] * z) * words_];
          // The first row of a cube may be the last of another one, those behind it are all alike.
          const size_t first = y * edge, behind = y + 1 == cubes_[1] ? ny : first + edge;
          look(first, k, wanted.data());
          classify_rows(samples, nx, first + ny * k, 1, value_, wanted.data(), sure, bits, words_);
          look(first + 1, k, wanted.data());
          classify_rows(samples, nx, first + 1 + ny * k, behind - first - 1, value_, wanted.data(), sure, bits, words_);
        }
      },
      &context);
}

}  // namespace sg::contouring
