// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/contrast.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/parallel.h"

namespace sg::texture {

namespace {

constexpr size_t values_per_chunk = 1 << 16;
constexpr int bins = 4096;

struct Extent {
  float lo = HUGE_VALF, hi = -HUGE_VALF;
};

}  // namespace

void set_contrast(std::span<float> v, Contrast kind, bool from_zero, const Context& context) {
  if (kind == Contrast::none) return;
  const Extent e = parallel_reduce(
      v.size(), values_per_chunk, Extent(),
      [&](size_t begin, size_t end) {
        Extent r;
        for (size_t i = begin; i < end; ++i) {
          if (v[i] < r.lo) r.lo = v[i];
          if (v[i] > r.hi) r.hi = v[i];
        }
        return r;
      },
      [](Extent a, Extent b) {
        return Extent{std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
      },
      &context);
  if (!(e.lo < e.hi)) return;  // a constant stays what it is
  const float per_bin = float(bins) / (e.hi - e.lo);
  if (!(per_bin > 0 && std::isfinite(per_bin))) return;  // infinite or hardly different values have no bins
  auto bin = [&](float x) { return std::clamp(int((x - e.lo) * per_bin), 0, bins - 1); };
  using Counts = std::vector<uint64_t>;
  const Counts counts = parallel_reduce(
      v.size(), std::max(values_per_chunk, v.size() / 64 + 1), Counts(bins, 0),
      [&](size_t begin, size_t end) {
        Counts c(bins, 0);
        for (size_t i = begin; i < end; ++i)
          if (v[i] == v[i] && (!from_zero || v[i] > 0)) ++c[size_t(bin(v[i]))];
        return c;
      },
      [](Counts a, const Counts& b) {
        for (size_t i = 0; i < a.size(); ++i) a[i] += b[i];
        return a;
      },
      &context);
  uint64_t total = 0;
  for (const uint64_t c : counts) total += c;
  if (total == 0) return;
  if (kind == Contrast::equalise) {
    std::vector<float> below(bins + 1, 0);
    uint64_t sum = 0;
    for (int b = 0; b < bins; ++b) below[size_t(b) + 1] = float(double(sum += counts[size_t(b)]) / double(total));
    parallel_for(v.size(), values_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        if (!(v[i] == v[i])) continue;
        const size_t b = size_t(bin(v[i]));
        const float t = std::clamp((v[i] - e.lo) * per_bin - float(b), 0.0f, 1.0f);
        v[i] = below[b] + t * (below[b + 1] - below[b]);
      }
    });
    return;
  }
  auto value_below_which = [&](double part) {
    const double wanted = part * double(total);
    uint64_t sum = 0;
    for (int b = 0; b < bins; ++b) {
      const uint64_t c = counts[size_t(b)];
      if (double(sum + c) >= wanted && c > 0) return e.lo + (float(b) + float((wanted - double(sum)) / double(c))) / per_bin;
      sum += c;
    }
    return e.hi;
  };
  const float lo = from_zero ? 0.0f : value_below_which(0.01), hi = value_below_which(from_zero ? 0.95 : 0.99);
  if (!(lo < hi)) return;
  const float scale = 1 / (hi - lo);
  parallel_for(v.size(), values_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (v[i] == v[i]) v[i] = std::clamp((v[i] - lo) * scale, 0.0f, 1.0f);
  });
}

Plane<float> sharpened(std::span<const float> v, const int32_t n[3], const Context& context) {
  Plane<float> out(v.size());
  parallel_for(
      size_t(n[1]) * size_t(n[2]), 16,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          const int32_t j = int32_t(row % size_t(n[1])), k = int32_t(row / size_t(n[1]));
          for (int32_t i = 0; i < n[0]; ++i) {
            const size_t here = size_t(i) + size_t(n[0]) * row;
            float sum = 0;
            int count = 0;
            for (int32_t z = std::max(0, k - 1); z <= std::min(n[2] - 1, k + 1); ++z)
              for (int32_t y = std::max(0, j - 1); y <= std::min(n[1] - 1, j + 1); ++y)
                for (int32_t x = std::max(0, i - 1); x <= std::min(n[0] - 1, i + 1); ++x) {
                  const float w = v[size_t(x) + size_t(n[0]) * (size_t(y) + size_t(n[1]) * size_t(z))];
                  if (w == w) sum += w, ++count;
                }
            out[here] = count > 0 ? 2 * v[here] - sum / float(count) : v[here];
          }
        }
      },
      &context);
  return out;
}

}  // namespace sg::texture
