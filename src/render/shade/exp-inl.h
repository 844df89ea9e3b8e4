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

#include "base/simd/arithmetic-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::shading::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using simd::HWY_NAMESPACE::mul_add;
using simd::HWY_NAMESPACE::neg_mul_add;

/// exp(-x) for x >= 0 to 2e-7, 0 from 87 on.
template <class F>
HWY_INLINE F exp_minus(F x) {
  const hn::DFromV<F> d;
  const hn::RebindToSigned<hn::DFromV<F>> di;
  const auto deep = hn::Ge(x, hn::Set(d, 87.0f));
  x = hn::Min(x, hn::Set(d, 87.0f));
  const auto k = simd::HWY_NAMESPACE::truncated(mul_add(x, hn::Set(d, 1.44269504f), hn::Set(d, 0.5f)));
  const F kf = hn::ConvertTo(d, k);
  const F r = hn::Neg(neg_mul_add(kf, hn::Set(d, 1.42860677e-6f), neg_mul_add(kf, hn::Set(d, 0.693145752f), x)));
  F sum = hn::Set(d, 1.0f / 5040);
  for (const float c : {1.0f / 720, 1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) sum = mul_add(sum, r, hn::Set(d, c));
  const F power_of_two = hn::BitCast(d, hn::ShiftLeft<23>(hn::Sub(hn::Set(di, 127), k)));
  return hn::IfThenElseZero(hn::Not(deep), hn::Mul(sum, power_of_two));
}

/// 1 - exp(-x) for x >= 0, to a few units in the last place.
template <class F>
HWY_INLINE F absorbed(F x) {
  const hn::DFromV<F> d;
  const hn::RebindToSigned<hn::DFromV<F>> di;
  x = hn::Min(x, hn::Set(d, 80.0f));
  const auto k = simd::HWY_NAMESPACE::truncated(mul_add(x, hn::Set(d, 1.44269504f), hn::Set(d, 0.5f)));
  const F kf = hn::ConvertTo(d, k);
  // r = x - k ln 2 in two parts; e = 1 - exp(-r) by its series.
  const F r = neg_mul_add(kf, hn::Set(d, 1.42860677e-6f), neg_mul_add(kf, hn::Set(d, 0.693145752f), x));
  F e = hn::Set(d, 1.0f / 5040);
  for (const float c : {-1.0f / 720, 1.0f / 120, -1.0f / 24, 1.0f / 6, -0.5f, 1.0f}) e = mul_add(e, r, hn::Set(d, c));
  e = hn::Mul(e, r);
  const F power_of_two = hn::BitCast(d, hn::ShiftLeft<23>(hn::Sub(hn::Set(di, 127), k)));
  return mul_add(power_of_two, e, hn::Sub(hn::Set(d, 1.0f), power_of_two));
}

/// 2 artanh(z) for small z: the logarithm of (1 + z) / (1 - z).
template <class F>
HWY_INLINE F log_of_ratio(F z) {
  const hn::DFromV<F> d;
  const F square = hn::Mul(z, z);
  F sum = hn::Set(d, 1.0f / 9);
  for (const float c : {1.0f / 7, 1.0f / 5, 1.0f / 3, 1.0f}) sum = mul_add(sum, square, hn::Set(d, c));
  return hn::Mul(hn::Mul(hn::Set(d, 2.0f), z), sum);
}

/// -ln(1 - x) for 0 <= x < 1, to a few units in the last place: that of x / (2 - x) near 0, else of the mantissa of 1 - x.
template <class F>
HWY_INLINE F minus_log_of_rest(F x) {
  const hn::DFromV<F> d;
  const hn::RebindToSigned<hn::DFromV<F>> di;
  const F one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
  const auto bits = hn::BitCast(di, hn::Sub(one, x));
  const auto exponent = hn::ShiftRight<23>(hn::Sub(bits, hn::Set(di, 0x3F3504F3)));  // of a mantissa from sqrt(1/2) on
  const F mantissa = hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<23>(exponent)));
  const auto near = hn::RebindMask(d, hn::Eq(exponent, hn::Zero(di)));
  const F z = hn::Div(hn::IfThenElse(near, x, hn::Sub(one, mantissa)), hn::IfThenElse(near, hn::Sub(two, x), hn::Add(one, mantissa)));
  return mul_add(hn::ConvertTo(d, exponent), hn::Set(d, -0.693147181f), log_of_ratio(z));
}

/// -ln x for normal numbers x > 0, to 2e-7 of it or of 1: the mantissa in [sqrt(1/2), sqrt(2)) by the series of artanh.
template <class F>
HWY_INLINE F minus_log(F x) {
  const hn::DFromV<F> d;
  const hn::RebindToSigned<hn::DFromV<F>> di;
  const F one = hn::Set(d, 1.0f);
  const auto bits = hn::Sub(hn::BitCast(di, x), hn::Set(di, 0x3F3504F3));
  const auto exponent = hn::ShiftRight<23>(bits);
  const F mantissa = hn::BitCast(d, hn::Add(hn::And(bits, hn::Set(di, 0x7FFFFF)), hn::Set(di, 0x3F3504F3)));
  const F z = hn::Div(hn::Sub(mantissa, one), hn::Add(mantissa, one));
  return hn::Neg(mul_add(hn::ConvertTo(d, exponent), hn::Set(d, 0.693147181f), log_of_ratio(z)));
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
    if (whole_ == 0) return hn::Set(d, 1.0f);
    x = hn::Max(x, hn::Set(d, least_));
    if (whole_ < 0) return exp_minus(hn::Mul(hn::Set(d, p_), hn::Max(hn::Zero(d), minus_log(x))));
    int n = whole_;
    for (; (n & 1) == 0; n >>= 1) x = hn::Mul(x, x);
    F result = x;
    while (n >>= 1) {
      x = hn::Mul(x, x);
      if (n & 1) result = hn::Mul(result, x);
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
