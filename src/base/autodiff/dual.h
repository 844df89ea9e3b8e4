// SPDX-License-Identifier: Apache-2.0
// Forward automatic differentiation: a number with N derivatives. Dual<Dual<double>> carries second derivatives.
#pragma once
#include <array>
#include <concepts>

#include "base/autodiff/functions.h"

namespace sg::autodiff {

/// value + d[0] e0 + ... + d[N-1] eN-1 with ei ej = 0: after any arithmetic d[i] is the derivative along the direction that the inputs'
/// d[i] stated (Griewank, Walther: Evaluating Derivatives, 2008, chapter 3). Compares by its plain value.
template <class T = double, int N = 1>
struct Dual {
  using Inner = T;
  T value{};
  std::array<T, N> d{};

  Dual() = default;
  /// A constant.
  template <class U>
  requires std::convertible_to<const U&, T> Dual(const U& v) : value(v) {}  // NOLINT: numbers mix with plain ones
  Dual(T v, std::array<T, N> derivatives) : value(v), d(derivatives) {}
  /// The i-th of the numbers with respect to which is derived.
  static Dual variable(T v, int i) {
    Dual x(v);
    x.d[size_t(i)] = T(1);
    return x;
  }

  /// f(this), where f has this value and slope.
  Dual through(const T& f, const T& slope) const {
    Dual r(f);
    for (size_t i = 0; i < N; ++i) r.d[i] = slope * d[i];
    return r;
  }
  /// f(this, b), where f has this value and these slopes.
  Dual through(const Dual& b, const T& f, const T& slope_a, const T& slope_b) const {
    Dual r(f);
    for (size_t i = 0; i < N; ++i) r.d[i] = slope_a * d[i] + slope_b * b.d[i];
    return r;
  }

  friend Dual operator+(const Dual& a, const Dual& b) {
    Dual r(a.value + b.value);
    for (size_t i = 0; i < N; ++i) r.d[i] = a.d[i] + b.d[i];
    return r;
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    Dual r(a.value - b.value);
    for (size_t i = 0; i < N; ++i) r.d[i] = a.d[i] - b.d[i];
    return r;
  }
  friend Dual operator-(const Dual& a) {
    Dual r(-a.value);
    for (size_t i = 0; i < N; ++i) r.d[i] = -a.d[i];
    return r;
  }
  friend Dual operator*(const Dual& a, const Dual& b) { return a.through(b, a.value * b.value, b.value, a.value); }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T f = a.value / b.value;
    return a.through(b, f, T(1) / b.value, -f / b.value);
  }
  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }
  friend bool operator<(const Dual& a, const Dual& b) { return plain(a) < plain(b); }
  friend bool operator>(const Dual& a, const Dual& b) { return plain(a) > plain(b); }
};

}  // namespace sg::autodiff
