// SPDX-License-Identifier: Apache-2.0
#include "filter/stats/finite_numbers.h"

#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace sg {

namespace {

constexpr size_t numbers_per_chunk = 1 << 16;

template <class V>
double number_at(const V& view, size_t i, int component) {
  if (component >= 0) return double(view(i, component));
  double x = 0;
  for (int c = 0; c < view.components; ++c) x += double(view(i, c)) * double(view(i, c));
  // Squares reach beyond doubles sooner than lengths do.
  if (!(x > 1e-290 && x < 1e290)) {
    x = 0;
    for (int c = 0; c < view.components; ++c) x = std::hypot(x, double(view(i, c)));
  } else {
    x = std::sqrt(x);
  }
  for (int c = 0; c < view.components; ++c)
    if (double(view(i, c)) != double(view(i, c))) x = std::nan("");
  return x;
}

struct KindCounts {
  size_t finite = 0, missing = 0, infinite = 0;
};

// Calls f(x) for each number of a chunk.
template <class F>
void each_number(const FiniteNumbers::Source& s, int component, size_t begin, size_t end, F&& f) {
  dispatch(*s.array, [&](const auto& view) {
    const uint8_t* ghost = s.ghost->empty() ? nullptr : s.ghost->view<uint8_t>().data;
    for (size_t i = begin; i < end; ++i)
      if (!ghost || ghost[i] == 0) f(number_at(view, i, component));
  });
}

}  // namespace

FiniteNumbers::FiniteNumbers(std::span<const Source> sources, int component) {
  // Counted first, so that each chunk knows where its numbers go.
  std::vector<std::vector<KindCounts>> counts;
  for (const Source& s : sources) {
    const size_t n = s.array->count();
    auto& chunks = counts.emplace_back((n + numbers_per_chunk - 1) / numbers_per_chunk);
    parallel_for(n, numbers_per_chunk, [&](size_t begin, size_t end) {
      KindCounts c;
      each_number(s, component, begin, end, [&](double x) {
        if (std::isfinite(x)) ++c.finite;
        else if (std::isnan(x)) ++c.missing;
        else ++c.infinite;
      });
      chunks[begin / numbers_per_chunk] = c;
    });
    for (KindCounts& c : chunks) {
      const size_t here = c.finite;
      c.finite = count_;  // from here on where the chunk begins
      count_ += here, missing_ += c.missing, infinite_ += c.infinite;
    }
  }
  values_ = std::make_unique_for_overwrite<double[]>(count_);
  for (size_t k = 0; k < sources.size(); ++k)
    parallel_for(sources[k].array->count(), numbers_per_chunk, [&](size_t begin, size_t end) {
      double* to = values_.get() + counts[k][begin / numbers_per_chunk].finite;
      each_number(sources[k], component, begin, end, [&](double x) {
        if (std::isfinite(x)) *to++ = x;
      });
    });
}

}  // namespace sg
