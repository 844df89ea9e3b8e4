// SPDX-License-Identifier: Apache-2.0
// exp_minus() of exp.h for vectors, and powers; for files that are compiled once for each target and have included Highway. No libm:
// every target gives the same bits.
#if defined(SG_SHADE_EXP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_SHADE_EXP_INL_H
#undef SG_SHADE_EXP_INL_H
#else
#define SG_SHADE_EXP_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "base/simd/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::shading::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

/// exp(-x) for x >= 0 to 2e-7, 0 from 87 on.
template <class F>
HWY_INLINE F exp_minus(F x) {
  const hn::DFromV<F> d;
  const auto deep = x >= 87.0f;
  x = min(x, 87.0f);
  const auto k = truncated(mul_add(x, 1.44269504f, 0.5f));
  const F kf = convert(d, k);
  const F r = -neg_mul_add(kf, 1.42860677e-6f, neg_mul_add(kf, 0.693145752f, x));
  F sum = set(d, 1.0f / 5040);
  for (const float c : {1.0f / 720, 1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) sum = mul_add(sum, r, c);
  const F power_of_two = bit_cast(d, shift_left<23>(127 - k));
  return only(!deep, sum * power_of_two);
}

/// 1 - exp(-x) for x >= 0, to a few units in the last place.
template <class F>
HWY_INLINE F absorbed(F x) {
  const hn::DFromV<F> d;
  x = min(x, 80.0f);
  const auto k = truncated(mul_add(x, 1.44269504f, 0.5f));
  const F kf = convert(d, k);
  // r = x - k ln 2 in two parts; e = 1 - exp(-r) by its series.
  const F r = neg_mul_add(kf, 1.42860677e-6f, neg_mul_add(kf, 0.693145752f, x));
  F e = set(d, 1.0f / 5040);
  for (const float c : {-1.0f / 720, 1.0f / 120, -1.0f / 24, 1.0f / 6, -0.5f, 1.0f}) e = mul_add(e, r, c);
  e = e * r;
  const F power_of_two = bit_cast(d, shift_left<23>(127 - k));
  return mul_add(power_of_two, e, 1.0f - power_of_two);
}

/// 2 artanh(z) for small z: the logarithm of (1 + z) / (1 - z).
template <class F>
HWY_INLINE F log_of_ratio(F z) {
  const hn::DFromV<F> d;
  const F square = z * z;
  F sum = set(d, 1.0f / 9);
  for (const float c : {1.0f / 7, 1.0f / 5, 1.0f / 3, 1.0f}) sum = mul_add(sum, square, c);
  return 2.0f * z * sum;
}

/// -ln(1 - x) for 0 <= x < 1, to a few units in the last place: that of x / (2 - x) near 0, else of the mantissa of 1 - x.
template <class F>
HWY_INLINE F minus_log_of_rest(F x) {
  const hn::DFromV<F> d;
  const hn::RebindToSigned<hn::DFromV<F>> di;
  const F one = set(d, 1.0f), two = set(d, 2.0f);
  const auto bits = bit_cast(di, one - x);
  const auto exponent = shift_right<23>(bits - 0x3F3504F3);  // of a mantissa from sqrt(1/2) on
  const F mantissa = bit_cast(d, bits - shift_left<23>(exponent));
  const auto near = rebind(d, exponent == 0);
  const F z = select(near, x, one - mantissa) / select(near, two - x, one + mantissa);
  return mul_add(convert(d, exponent), -0.693147181f, log_of_ratio(z));
}

/// -ln x for normal numbers x > 0, to 2e-7 of it or of 1: the mantissa in [sqrt(1/2), sqrt(2)) by the series of artanh.
template <class F>
HWY_INLINE F minus_log(F x) {
  const hn::DFromV<F> d;
  const hn::RebindToSigned<hn::DFromV<F>> di;
  const F one = set(d, 1.0f);
  const auto bits = bit_cast(di, x) - 0x3F3504F3;
  const auto exponent = shift_right<23>(bits);
  const F mantissa = bit_cast(d, (bits & 0x7FFFFF) + 0x3F3504F3);
  const F z = (mantissa - one) / (mantissa + one);
  return -mul_add(convert(d, exponent), 0.693147181f, log_of_ratio(z));
}

/// x^p for x in [0, 1] and one p >= 0 for all: by squaring for whole p up to 4096, else exp(p ln x).
class Power {
 public:
  Power() = default;
  explicit Power(float p)
      : p_(p), whole_(p <= 4096 && p == float(int(p)) ? int(p) : -1), least_(std::pow(10.0f, -36 / std::max(1.0f, p))) {}

  template <class F>
  HWY_INLINE F operator()(F x) const {
    const hn::DFromV<F> d;
    if (whole_ == 0) return set(d, 1.0f);
    x = max(x, least_);
    if (whole_ < 0) return exp_minus(p_ * max(0, minus_log(x)));
    int n = whole_;
    for (; (n & 1) == 0; n >>= 1) x = x * x;
    F result = x;
    while (n >>= 1) {
      x = x * x;
      if (n & 1) result = result * x;
    }
    return result;
  }

 private:
  float p_ = 1;
  int whole_ = 1;
  float least_ = 0;  // what is raised: smaller than this its power would be no normal number
};

}  // namespace sg::shading::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
