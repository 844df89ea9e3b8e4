// SPDX-License-Identifier: Apache-2.0
// Elementary functions of numbers that carry derivatives, written once for duals and for variables of a tape: f(x) and f'(x) in the numbers
// underneath, which may carry derivatives themselves.
#pragma once
#include <algorithm>
#include <cmath>
#include <concepts>
#include <numbers>

namespace sg::autodiff {

/// A number with a `value`, and `through`: what becomes of its derivatives under a function whose value and slope are given.
template <class X>
concept Differentiable = requires(const X& x) {
  typename X::Inner;
  x.through(x.value, x.value);
  x.through(x, x.value, x.value, x.value);
};

/// The plain number inside of any nesting.
inline double plain(double x) { return x; }
template <Differentiable X>
double plain(const X& x) {
  return plain(x.value);
}

#define SG_AUTODIFF_1(name, slope)                                                                                                        \
  template <Differentiable X>                                                                                                             \
  X name(const X& x) {                                                                                                                    \
    using std::sin, std::cos, std::tan, std::sinh, std::cosh, std::tanh, std::sqrt, std::exp, std::log, std::log2, std::log10, std::cbrt, \
        std::asin, std::acos, std::atan;                                                                                                  \
    using T [[maybe_unused]] = typename X::Inner;                                                                                         \
    const auto& a = x.value;                                                                                                              \
    const auto f = name(a);                                                                                                               \
    return x.through(f, slope);                                                                                                           \
  }
SG_AUTODIFF_1(sin, cos(a))
SG_AUTODIFF_1(cos, -sin(a))
SG_AUTODIFF_1(tan, 1.0 + f * f)
SG_AUTODIFF_1(asin, 1.0 / sqrt((1.0 - a) * (1.0 + a)))
SG_AUTODIFF_1(acos, -1.0 / sqrt((1.0 - a) * (1.0 + a)))
SG_AUTODIFF_1(atan, 1.0 / (1.0 + a * a))
SG_AUTODIFF_1(sinh, cosh(a))
SG_AUTODIFF_1(cosh, sinh(a))
SG_AUTODIFF_1(tanh, (1.0 - f) * (1.0 + f))
SG_AUTODIFF_1(exp, f)
SG_AUTODIFF_1(log, 1.0 / a)
SG_AUTODIFF_1(log2, 1.0 / (a * std::numbers::ln2))
SG_AUTODIFF_1(log10, 1.0 / (a * std::numbers::ln10))
SG_AUTODIFF_1(sqrt, 0.5 / f)
SG_AUTODIFF_1(cbrt, 1.0 / (3.0 * f * f))
#undef SG_AUTODIFF_1

/// The slope of |x| at 0 is taken for 0.
template <Differentiable X>
X abs(const X& x) {
  const double s = plain(x);
  return s > 0 ? x : s < 0 ? -x : x.through(x.value, typename X::Inner(0));
}

/// x to a constant power: whole ones have derivatives at 0, too.
template <Differentiable X>
X pow(const X& x, double n) {
  using std::pow;
  using T = typename X::Inner;
  return x.through(pow(x.value, n), n == 0 ? T(0) : n * pow(x.value, n - 1));
}
/// a^b for a above 0, in both.
template <Differentiable X>
X pow(const X& a, const X& b) {
  using std::pow, std::log;
  const auto f = pow(a.value, b.value);
  return a.through(b, f, b.value * pow(a.value, b.value - 1.0), f * log(a.value));
}
template <Differentiable X>
X pow(double a, const X& b) {
  using std::pow;
  const auto f = pow(typename X::Inner(a), b.value);
  return b.through(f, f * std::log(a));
}

template <Differentiable X>
X atan2(const X& y, const X& x) {
  using std::atan2;
  const auto r2 = x.value * x.value + y.value * y.value;
  return y.through(x, atan2(y.value, x.value), x.value / r2, -y.value / r2);
}
/// Its slopes at (0, 0) are not numbers.
template <Differentiable X>
X hypot(const X& a, const X& b) {
  using std::hypot;
  const auto f = hypot(a.value, b.value);
  return a.through(b, f, a.value / f, b.value / f);
}
template <Differentiable X>
X min(const X& a, const X& b) {
  return plain(b) < plain(a) ? b : a;
}
template <Differentiable X>
X max(const X& a, const X& b) {
  return plain(a) < plain(b) ? b : a;
}

}  // namespace sg::autodiff
