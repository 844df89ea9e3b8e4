// SPDX-License-Identifier: Apache-2.0
// The trilinear field of a cell along a ray: a cubic.
#if defined(SG_PACKET_CUBIC_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_CUBIC_INL_H
#undef SG_PACKET_CUBIC_INL_H
#else
#define SG_PACKET_CUBIC_INL_H
#endif

#include "render/volume/engines/packets/packets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// a + b s + c s^2 + e s^3.
template <class D>
struct Cubic {
  Float<D> a, b, c, e, last;  // last: at s = 1
  HWY_INLINE Float<D> at(Float<D> s) const { return mul_add(s, mul_add(s, mul_add(s, e, c), b), a); }
  HWY_INLINE Cubic times(Float<D> x) const { return {a * x, b * x, c * x, e * x, last * x}; }
  HWY_INLINE Cubic plus(const Cubic& o, Float<D> x) const {
    return {mul_add(o.a, x, a), mul_add(o.b, x, b), mul_add(o.c, x, c), mul_add(o.e, x, e), mul_add(o.last, x, last)};
  }
  /// Bounds on [0, 1]: those of the Bernstein coefficients.
  HWY_INLINE void hull(Float<D>& lo, Float<D>& hi) const {
    const auto third = set(D(), 1.0f / 3), b1 = mul_add(b, third, a), b2 = mul_add(b + c, third, b1);
    lo = min(min(a, b1), min(b2, last)), hi = max(max(a, b1), max(b2, last));
  }
  /// Where it has its zero between s and end, at0 and at1 there of different signs: false position that halves what an end that stays has
  /// (Illinois).
  HWY_NOINLINE Float<D> zero_between(Float<D> s, Float<D> end, Float<D> at0, Float<D> at1) const {
    using F = Float<D>;
    const D d;
    const F zero = set(d, 0), half = set(d, 0.5f);
    F meet = s;
    for (int i = 0; i < 16; ++i) {
      const F apart = at0 - at1, wide = end - s;
      const F share = select(apart == zero, half, at0 / select(apart == zero, half, apart));
      meet = mul_add(wide, share, s);
      const F here = at(meet);
      const auto later = (here > zero) ^ (at1 > zero);
      at0 = select(later, here, half * at0), at1 = select(later, half * at1, here);
      s = select(later, meet, s), end = select(later, end, meet);
    }
    return meet;
  }
  /// Where its derivative b + 2 c s + 3 e s^2 is zero; anything but a number in (0, 1) where it is not.
  HWY_INLINE void turns(Float<D>& first, Float<D>& second) const {
    const D d;
    const auto triple = 3.0f * e, square = neg_mul_add(triple, b, c * c);
    const auto root = sqrt(max(0, square)), none = set(d, 2.0f);
    const auto w = -(c + copy_sign(root, c));
    const auto some = square >= 0;
    first = select(some & (w != 0), b / w, none);
    second = select(some & (triple != 0), w / triple, none);
  }
};

/// The trilinear field of a cell along the way from + s * way, corners by rows (Source::corners).
template <class D>
HWY_INLINE Cubic<D> along_way(const Pair<D> rows[4], const Float<D> from[3], const Float<D> way[3]) {
  using F = Float<D>;
  struct Linear {
    F a, b;
  };
  struct Square {
    F a, b, c;
  };
  const auto x = [&](const Pair<D>& p) HWY_ATTR {
    const F rise = p.b - p.a;
    return Linear{mul_add(from[0], rise, p.a), way[0] * rise};
  };
  const auto y = [&](const Linear& p, const Linear& q) HWY_ATTR {
    const F rise = q.a - p.a, bend = q.b - p.b;
    return Square{mul_add(from[1], rise, p.a), mul_add(way[1], rise, mul_add(from[1], bend, p.b)), way[1] * bend};
  };
  const Square p = y(x(rows[0]), x(rows[1])), q = y(x(rows[2]), x(rows[3]));
  const F da = q.a - p.a, db = q.b - p.b, dc = q.c - p.c;
  Cubic<D> f;
  f.a = mul_add(from[2], da, p.a);
  f.b = mul_add(way[2], da, mul_add(from[2], db, p.b));
  f.c = mul_add(way[2], db, mul_add(from[2], dc, p.c));
  f.e = way[2] * dc;
  f.last = f.a + f.b + (f.c + f.e);
  return f;
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
