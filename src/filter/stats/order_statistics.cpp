// SPDX-License-Identifier: Apache-2.0
#include "filter/stats/order_statistics.h"

#include <algorithm>

#include "base/parallel.h"

namespace sg {

namespace {

constexpr int digits = 4, digit_bits = 16;
constexpr size_t keys_per_chunk = 1 << 20;  // each chunk has counts of its own
using DigitCounts = std::vector<uint64_t>;

size_t digit(uint64_t key, int level) { return size_t(key >> (64 - digit_bits * (level + 1)) & 0xffff); }
// -0 is 0.
uint64_t key_at(std::span<const double> v, size_t i) { return key_of(v[i] + 0.0); }

// How many numbers have each digit.
DigitCounts counts_of(std::span<const double> v, int level) {
  return parallel_reduce(
      v.size(), keys_per_chunk, DigitCounts(size_t(1) << digit_bits),
      [&](size_t begin, size_t end) {
        DigitCounts part(size_t(1) << digit_bits);
        for (size_t i = begin; i < end; ++i) ++part[digit(key_at(v, i), level)];
        return part;
      },
      [](DigitCounts all, const DigitCounts& part) {
        for (size_t d = 0; d < all.size(); ++d) all[d] += part[d];
        return all;
      });
}

// Those with this digit, in any fixed order.
std::vector<double> with_digit(std::span<const double> v, int level, size_t wanted) {
  using List = std::vector<double>;
  return parallel_reduce(
      v.size(), keys_per_chunk, List(),
      [&](size_t begin, size_t end) {
        List part;
        for (size_t i = begin; i < end; ++i)
          if (digit(key_at(v, i), level) == wanted) part.push_back(v[i]);
        return part;
      },
      [](List all, const List& part) {
        all.insert(all.end(), part.begin(), part.end());
        return all;
      });
}

// Fills `found` for places from `before` on, which numbers come before all of `v`.
void find_places(std::span<const double> v, int level, size_t before, std::span<const size_t> places, std::vector<double>& found) {
  constexpr size_t few = 4096;
  if (v.size() <= few) {
    std::vector<uint64_t> keys(v.size());
    for (size_t i = 0; i < v.size(); ++i) keys[i] = key_at(v, i);
    std::sort(keys.begin(), keys.end());
    for (const size_t p : places) found.push_back(number_of(keys[p - before]));
    return;
  }
  const DigitCounts counts = counts_of(v, level);
  size_t d = 0, first = 0;
  while (first < places.size()) {
    while (before + counts[d] <= places[first]) before += counts[d++];
    size_t last = first;
    while (last < places.size() && places[last] < before + counts[d]) ++last;
    const auto here = places.subspan(first, last - first);
    if (level + 1 == digits) {
      const size_t any =
          size_t(std::find_if(v.begin(), v.end(), [&](const double& x) { return digit(key_of(x + 0.0), level) == d; }) - v.begin());
      found.insert(found.end(), here.size(), number_of(key_at(v, any)));
    } else {
      find_places(with_digit(v, level, d), level + 1, before, here, found);
    }
    first = last;
  }
}

}  // namespace

std::vector<double> numbers_in_order(std::span<const double> v, std::span<const size_t> places) {
  std::vector<double> found;
  find_places(v, 0, 0, places, found);
  return found;
}

}  // namespace sg
