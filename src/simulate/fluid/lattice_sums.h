// SPDX-License-Identifier: Apache-2.0
// Sums over a lattice, the same for any number of threads.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "base/context.h"
#include "base/parallel.h"
#include "simulate/fluid/mac_grid.h"

namespace sg::fluid {

constexpr size_t values_at_once = 1 << 15;

/// The scalar product of two lattices of the same size.
template <class T>
double dot(const Lattice<T>& a, const Lattice<T>& b, const Context& context) {
  return parallel_reduce(
      a.values.size(), values_at_once, 0.0,
      [&](size_t begin, size_t end) {
        // Eight sums side by side: one alone would wait for itself.
        const T *const av = a.values.data(), *const bv = b.values.data();
        double sums[8] = {};
        size_t i = begin;
        for (; i + 8 <= end; i += 8)
          for (size_t k = 0; k < 8; ++k) sums[k] += double(av[i + k]) * double(bv[i + k]);
        for (size_t k = 0; i < end; ++i, ++k) sums[k] += double(av[i]) * double(bv[i]);
        return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
      },
      [](double x, double y) { return x + y; }, &context);
}

/// The largest absolute value; NaN where there is one.
template <class T>
double largest(const Lattice<T>& a, const Context& context) {
  return parallel_reduce(
      a.values.size(), values_at_once, 0.0,
      [&](size_t begin, size_t end) {
        // As whole numbers absolute values have the same order, and NaN is beyond all of them.
        using Bits = std::conditional_t<sizeof(T) == 4, int32_t, int64_t>;
        const T* const v = a.values.data();
        Bits m = 0;
        for (size_t i = begin; i < end; ++i) {
          const Bits size = std::bit_cast<Bits>(v[i]) & std::numeric_limits<Bits>::max();
          m = size > m ? size : m;
        }
        return double(std::bit_cast<T>(m));
      },
      [](double x, double y) { return x != x || y <= x ? x : y; }, &context);
}

}  // namespace sg::fluid
