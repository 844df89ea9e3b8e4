// SPDX-License-Identifier: Apache-2.0
// The trilinear field of a cell along a ray: a cubic.
#if defined(SG_PACKET_CUBIC_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_CUBIC_INL_H
#undef SG_PACKET_CUBIC_INL_H
#else
#define SG_PACKET_CUBIC_INL_H
#endif

#include "render/volume/engines/packets/packets_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// a + b s + c s^2 + e s^3.
template <class D>
struct Cubic {
  hn::Vec<D> a, b, c, e, last;  // last: at s = 1
  HWY_INLINE hn::Vec<D> at(hn::Vec<D> s) const { return mul_add(s, mul_add(s, mul_add(s, e, c), b), a); }
  HWY_INLINE Cubic times(hn::Vec<D> x) const { return {hn::Mul(a, x), hn::Mul(b, x), hn::Mul(c, x), hn::Mul(e, x), hn::Mul(last, x)}; }
  HWY_INLINE Cubic plus(const Cubic& o, hn::Vec<D> x) const {
    return {mul_add(o.a, x, a), mul_add(o.b, x, b), mul_add(o.c, x, c), mul_add(o.e, x, e), mul_add(o.last, x, last)};
  }
  /// Bounds on [0, 1]: those of the Bernstein coefficients.
  HWY_INLINE void hull(hn::Vec<D>& lo, hn::Vec<D>& hi) const {
    const auto third = hn::Set(D(), 1.0f / 3), b1 = mul_add(b, third, a), b2 = mul_add(hn::Add(b, c), third, b1);
    lo = hn::Min(hn::Min(a, b1), hn::Min(b2, last)), hi = hn::Max(hn::Max(a, b1), hn::Max(b2, last));
  }
  /// Where it has its zero between s and end, at0 and at1 there of different signs: false position that halves what an end that stays has
  /// (Illinois).
  HWY_NOINLINE hn::Vec<D> zero_between(hn::Vec<D> s, hn::Vec<D> end, hn::Vec<D> at0, hn::Vec<D> at1) const {
    using F = hn::Vec<D>;
    const D d;
    const F zero = hn::Zero(d), half = hn::Set(d, 0.5f);
    F meet = s;
    for (int i = 0; i < 16; ++i) {
      const F apart = hn::Sub(at0, at1), wide = hn::Sub(end, s);
      const F share = hn::IfThenElse(hn::Eq(apart, zero), half, hn::Div(at0, hn::IfThenElse(hn::Eq(apart, zero), half, apart)));
      meet = mul_add(wide, share, s);
      const F here = at(meet);
      const auto later = hn::Xor(hn::Gt(here, zero), hn::Gt(at1, zero));
      at0 = hn::IfThenElse(later, here, hn::Mul(half, at0)), at1 = hn::IfThenElse(later, hn::Mul(half, at1), here);
      s = hn::IfThenElse(later, meet, s), end = hn::IfThenElse(later, end, meet);
    }
    return meet;
  }
  /// Where its derivative b + 2 c s + 3 e s^2 is zero; anything but a number in (0, 1) where it is not.
  HWY_INLINE void turns(hn::Vec<D>& first, hn::Vec<D>& second) const {
    const D d;
    const auto triple = hn::Mul(hn::Set(d, 3.0f), e), square = neg_mul_add(triple, b, hn::Mul(c, c));
    const auto root = hn::Sqrt(hn::Max(hn::Zero(d), square)), none = hn::Set(d, 2.0f);
    const auto w = hn::Neg(hn::Add(c, hn::CopySign(root, c)));
    const auto some = hn::Ge(square, hn::Zero(d));
    first = hn::IfThenElse(hn::And(some, hn::Ne(w, hn::Zero(d))), hn::Div(b, w), none);
    second = hn::IfThenElse(hn::And(some, hn::Ne(triple, hn::Zero(d))), hn::Div(w, triple), none);
  }
};

/// The trilinear field of a cell along the way from + s * way, corners by rows (Source::corners).
template <class D>
HWY_INLINE Cubic<D> along_way(const Pair<D> rows[4], const hn::Vec<D> from[3], const hn::Vec<D> way[3]) {
  using F = hn::Vec<D>;
  struct Linear {
    F a, b;
  };
  struct Square {
    F a, b, c;
  };
  const auto x = [&](const Pair<D>& p) HWY_ATTR {
    const F rise = hn::Sub(p.b, p.a);
    return Linear{mul_add(from[0], rise, p.a), hn::Mul(way[0], rise)};
  };
  const auto y = [&](const Linear& p, const Linear& q) HWY_ATTR {
    const F rise = hn::Sub(q.a, p.a), bend = hn::Sub(q.b, p.b);
    return Square{mul_add(from[1], rise, p.a), mul_add(way[1], rise, mul_add(from[1], bend, p.b)), hn::Mul(way[1], bend)};
  };
  const Square p = y(x(rows[0]), x(rows[1])), q = y(x(rows[2]), x(rows[3]));
  const F da = hn::Sub(q.a, p.a), db = hn::Sub(q.b, p.b), dc = hn::Sub(q.c, p.c);
  Cubic<D> f;
  f.a = mul_add(from[2], da, p.a);
  f.b = mul_add(way[2], da, mul_add(from[2], db, p.b));
  f.c = mul_add(way[2], db, mul_add(from[2], dc, p.c));
  f.e = hn::Mul(way[2], dc);
  f.last = hn::Add(hn::Add(f.a, f.b), hn::Add(f.c, f.e));
  return f;
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
