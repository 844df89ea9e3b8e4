// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/contour_active.h"

#include "base/parallel.h"
#include "data/memory/memo.h"

namespace sg::contouring {

namespace {

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
    size_t nx = 1;  // the first axis of more than one point
    for (size_t n : lattice_dims(job.input.mesh()))
      if (nx == 1) nx = n;
    const size_t rows = job.samples.count() / nx, words = (nx + 63) / 64;
    bool nan = false;
    LatticeIndex made{find_ranges(job.samples, nx, rows, nan, job.context), {}};
    if (nan) {
      made.missing.resize(rows * words);
      find_missing(job.samples, nx, rows, made.missing.data(), words, job.context);
    }
    return made;
  });
}

std::shared_ptr<const CellActiveIndex> cell_index(const Job& job, const std::string& key, size_t values) {
  return remembered<CellActiveIndex>(job, "cell index " + key, values,
                                     [&] { return cell_active_index(job.input, job.samples, job.context); });
}

}  // namespace sg::contouring
