// SPDX-License-Identifier: Apache-2.0
// Sums over a lattice, the same for any number of threads.
#pragma once
#include <algorithm>
#include <cmath>

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
        double s = 0;
        for (size_t i = begin; i < end; ++i) s += double(a.values[i]) * double(b.values[i]);
        return s;
      },
      [](double x, double y) { return x + y; }, &context);
}

/// The largest absolute value; NaN where there is one.
template <class T>
double largest(const Lattice<T>& a, const Context& context) {
  return parallel_reduce(
      a.values.size(), values_at_once, 0.0,
      [&](size_t begin, size_t end) {
        T m = 0;
        for (size_t i = begin; i < end; ++i) {
          const T v = std::abs(a.values[i]);
          m = v <= m ? m : v;
          if (v != v) return double(v);
        }
        return double(m);
      },
      [](double x, double y) { return x != x || y <= x ? x : y; }, &context);
}

}  // namespace sg::fluid
