// SPDX-License-Identifier: Apache-2.0
// Light along two strides of a packet of rays: known at their ends and between them, a parabola through the three.
#if defined(SG_PACKET_LIT_STRIDES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_LIT_STRIDES_INL_H
#undef SG_PACKET_LIT_STRIDES_INL_H
#else
#define SG_PACKET_LIT_STRIDES_INL_H
#endif

#include "render/volume/engines/packets/packet_light_inl.h"
#include "render/volume/engines/packets/packet_slopes_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// Light at one place of each ray, on the face that is seen.
template <class D>
struct LitPlace {
  LitLanes<D> light;
  FieldSurface<D> surface;
  hn::Vec<D> nearest;  ///< of Lighting::on, as
  Int<D> sides;

  /// Where the field has that slope.
  static HWY_INLINE LitPlace at(const Lighting<D>& lighting, const Slope<D>& slope) {
    const hn::Vec<D> cells[3] = {slope.x, slope.y, slope.z};
    hn::Vec<D> g[3];
    lighting.to_world(cells, g);
    LitPlace p;
    p.surface = lighting.surface(g), p.light = lighting.on(p.surface, p.sides, p.nearest);
    return p;
  }
  static HWY_INLINE LitPlace none() {
    const auto zero = hn::Zero(D());
    return {{zero, zero}, {{zero, zero, zero}, zero, zero}, zero, hn::Zero(IntTag<D>())};
  }
  HWY_INLINE LitPlace permuted(Int<D> order) const {
    const D d;
    const auto to = hn::IndicesFromVec(d, order);
    LitPlace p;
    p.each(*this, [&](hn::Vec<D>& mine, hn::Vec<D> theirs) HWY_ATTR { mine = hn::TableLookupLanes(theirs, to); });
    p.sides = hn::BitCast(IntTag<D>(), hn::TableLookupLanes(hn::BitCast(d, sides), to));
    return p;
  }
  HWY_INLINE void take(const LitPlace& o, hn::Mask<D> which) {
    each(o, [&](hn::Vec<D>& mine, hn::Vec<D> theirs) HWY_ATTR { mine = hn::IfThenElse(which, theirs, mine); });
    sides = hn::IfThenElse(hn::RebindMask(IntTag<D>(), which), o.sides, sides);
  }

 private:
  template <class Do>
  HWY_INLINE void each(const LitPlace& o, const Do& act) {
    act(light.diffuse, o.light.diffuse), act(light.specular, o.light.specular);
    for (int a = 0; a < 3; ++a) act(surface.normal[a], o.surface.normal[a]);
    act(surface.along, o.surface.along), act(surface.much, o.surface.much), act(nearest, o.nearest);
  }
};

/// How straight the gradient goes along a ray, told from the last two places.
template <class D>
class GradientPath {
  using F = hn::Vec<D>;

 public:
  HWY_INLINE GradientPath() : length_(hn::Zero(D())) {
    for (F& c : change_) c = hn::Zero(D());
  }
  /// By what share of its change from here to p2, so far away, it may leave the straight line between them. Where there is nothing to
  /// compare with, what rough fields do.
  HWY_INLINE F swerve(const LitPlace<D>& here, const LitPlace<D>& p2, F length) const {
    const D d;
    const F ratio = hn::Div(length, hn::Max(length_, hn::Set(d, 1e-30f)));
    F change[3], bend[3];
    step(here, p2, change);
    for (int a = 0; a < 3; ++a) bend[a] = neg_mul_add(change_[a], ratio, change[a]);
    // The second derivative s counts by s length^2 / 8 in the middle.
    const F size = hn::Max(Lighting<D>::dot(change, change), hn::Set(d, 1e-30f));
    const F share = hn::Div(length, hn::Mul(hn::Set(d, 4.0f), hn::Add(length, length_)));
    const F off = hn::Mul(share, hn::Sqrt(hn::Div(Lighting<D>::dot(bend, bend), size)));
    return hn::IfThenElse(known(), off, hn::Set(d, unknown));
  }
  HWY_INLINE void go(const LitPlace<D>& here, const LitPlace<D>& p2, F length, hn::Mask<D> which) {
    F change[3];
    step(here, p2, change);
    for (int a = 0; a < 3; ++a) change_[a] = hn::IfThenElse(which, change[a], change_[a]);
    length_ = hn::IfThenElse(which, length, length_);
  }
  HWY_INLINE void forget(hn::Mask<D> which) { length_ = hn::IfThenZeroElse(which, length_); }
  /// The lanes in which there is something to compare with.
  HWY_INLINE hn::Mask<D> known() const { return hn::Gt(length_, hn::Zero(D())); }

 private:
  static constexpr float unknown = 1.0f / 16;
  static HWY_INLINE void step(const LitPlace<D>& a, const LitPlace<D>& b, F change[3]) {
    for (int i = 0; i < 3; ++i)
      change[i] = hn::Sub(hn::Mul(b.surface.normal[i], b.surface.much), hn::Mul(a.surface.normal[i], a.surface.much));
  }
  F change_[3], length_;  // of the gradient, up to here; 0: not known
};

/// a + b x + c x^2 with x = -1, 0, 1 at the three places.
template <class D>
struct Parabola {
  hn::Vec<D> a, b, c;
  static HWY_INLINE Parabola through(hn::Vec<D> before, hn::Vec<D> middle, hn::Vec<D> after) {
    const auto half = hn::Set(D(), 0.5f);
    return {middle, hn::Mul(half, hn::Sub(after, before)), hn::Mul(half, hn::Add(hn::Sub(before, middle), hn::Sub(after, middle)))};
  }
  HWY_INLINE void take(const Parabola& o, hn::Mask<D> which) {
    a = hn::IfThenElse(which, o.a, a), b = hn::IfThenElse(which, o.b, b), c = hn::IfThenElse(which, o.c, c);
  }
  /// The mean over weights around x with that variance.
  HWY_INLINE hn::Vec<D> mean(hn::Vec<D> x, hn::Vec<D> variance) const {
    return hn::Add(a, mul_add(c, mul_add(x, x, variance), hn::Mul(b, x)));
  }
  HWY_INLINE hn::Vec<D> slope(hn::Vec<D> x) const { return mul_add(hn::Add(c, c), x, b); }
};

/// Light along two strides, and what is wrong with it as a share of what they take.
template <class D>
struct StrideLight {
  using F = hn::Vec<D>;
  Parabola<D> diffuse, specular;
  F error;

  /// Between the ends of both as the surface turns, which may `swerve` from that by a share of the change (GradientPath). Its error is more
  /// than anybody accepts where there is a kink.
  static HWY_INLINE StrideLight straight(const Lighting<D>& lighting, const LitPlace<D>& p0, const LitPlace<D>& p2, F swerve) {
    const D d;
    const F turn = turn_between(p0.surface, p2.surface), zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    // Half way the normal has turned by turned_half_way(), and light is that of so much of a surface.
    const Fade<D> fade(p0.surface, p2.surface, turn);
    const F per = hn::Div(fade.middle, hn::Max(hn::Add(p0.surface.much, p2.surface.much), hn::Set(d, 1e-30f)));
    const F share0 = hn::Mul(per, hn::Max(one, p0.surface.much)), share2 = hn::Mul(per, hn::Max(one, p2.surface.much));
    const auto between = [&](F a, F b, F flat) HWY_ATTR {
      return Parabola<D>::through(a, mul_add(share0, hn::Sub(a, flat), mul_add(share2, hn::Sub(b, flat), flat)), b);
    };
    StrideLight l{between(p0.light.diffuse, p2.light.diffuse, one), between(p0.light.specular, p2.light.specular, zero), zero};
    // The square of the angle by which the surface turns is 2 (1 - cos); an arc lies a twelfth of its bend above its chord in the mean.
    l.error = hn::Mul(turn, hn::Mul(lighting.bend(hn::Max(p0.nearest, p2.nearest), turn), hn::Set(d, 1.0f / 6)));
    l.error = mul_add(hn::Mul(fade.hollow, hn::Set(d, share_hollow)), lighting.most_fade(), l.error);
    l.error = hn::Add(l.error, beside_parabola(p0, p2));
    // Where the light at both ends is alike it may have been another in between, by the angle.
    const F angle = hn::Sqrt(hn::Max(zero, hn::Add(turn, turn)));
    const F astray = hn::Max(apart(p0.light, p2.light), hn::Mul(hn::Set(d, share_angle), angle));
    l.error = mul_add(astray, hn::Mul(hn::Set(d, 2.0f / 3), swerve), l.error);
    l.error = hn::IfThenElse(kinked(p0.sides, p2.sides), hn::Set(d, 1.0f), l.error);
    return l;
  }
  /// A parabola through the ends and the middle of strides of so much optical depth.
  static HWY_INLINE StrideLight curved(const Lighting<D>& lighting, const LitPlace<D>& p0, const LitPlace<D>& p1, const LitPlace<D>& p2,
                                       F depth) {
    const D d;
    StrideLight l{Parabola<D>::through(p0.light.diffuse, p1.light.diffuse, p2.light.diffuse),
                  Parabola<D>::through(p0.light.specular, p1.light.specular, p2.light.specular), hn::Zero(d)};
    const F turn01 = turn_between(p0.surface, p1.surface), turn12 = turn_between(p1.surface, p2.surface);
    const F square = hn::Mul(hn::Set(d, 4.0f), hn::Add(turn01, turn12));
    // The fourth derivative of a highlight is 3 power times its second.
    const F nearest = hn::Max(p1.nearest, hn::Max(p0.nearest, p2.nearest));
    const F lobe = hn::Mul(square, hn::Mul(hn::Set(d, lobe_share), lighting.bend(nearest, hn::Max(turn01, turn12))));
    const F bend = hn::Max(hn::Mul(hn::Set(d, 2.0f), hn::Add(hn::Abs(l.diffuse.c), hn::Abs(l.specular.c))), lobe);
    // What lies beside it before the middle and after cancels, but where the front hides the back.
    const F hidden = mul_add(hn::Min(depth, hn::Set(d, 4.0f)), hn::Set(d, share_hidden_half), hn::Set(d, share_least));
    const F share = mul_add(square, hn::Set(d, share_turned * lighting.material().power), hidden);
    // A jump may lie anywhere in its half, which has about half of what is taken.
    const auto jump = [&](const LitPlace<D>& a, const LitPlace<D>& b) HWY_ATTR {
      return hn::IfThenElseZero(kinked(a.sides, b.sides), hn::Mul(hn::Set(d, share_kinked), apart(a.light, b.light)));
    };
    const F hollows = hn::Add(Fade<D>(p0.surface, p1.surface, turn01).hollow, Fade<D>(p1.surface, p2.surface, turn12).hollow);
    const F faded = hn::Mul(hn::Mul(hollows, hn::Set(d, 0.5f * share_hollow)), lighting.most_fade());
    const F aside = hn::Add(faded, beside_parabola(p0, p2));
    l.error = hn::Max(hn::Mul(bend, share), hn::Add(aside, hn::Add(jump(p0, p1), jump(p1, p2))));
    // Between places on one side of the surface's edge, but so near to it, the other may be seen.
    const auto there_and_back = [&](const LitPlace<D>& a, const LitPlace<D>& b)
                                    HWY_ATTR { return hn::AndNot(kinked(a.sides, b.sides), grazing(a.surface, b.surface)); };
    l.error = hn::IfThenElse(hn::Or(there_and_back(p0, p1), there_and_back(p1, p2)), hn::Set(d, 1.0f), l.error);
    return l;
  }
  /// Where the surface turns over between the ends, and nothing else is a kink: each face on its part of the way, lit by a straight line
  /// between what it has at the ends. `tau` at the ends and the middle tells how much is taken on either part.
  static HWY_INLINE StrideLight turned_over(const Lighting<D>& lighting, const LitPlace<D>& p0, const LitPlace<D>& p2, const F tau[3],
                                            F depth) {
    const D d;
    const LitLanes<D> back0 = lighting.on_back(p0.surface), back2 = lighting.on_back(p2.surface);
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f), third = hn::Set(d, 1.0f / 3), least = hn::Set(d, 1e-30f);
    const F rise_0 = hn::Mul(p0.surface.along, p0.surface.much), rise_2 = hn::Mul(p2.surface.along, p2.surface.much);
    const F fall = hn::Sub(rise_0, rise_2);
    const F at = hn::Max(zero, hn::Min(hn::Div(rise_0, hn::IfThenElse(hn::Eq(fall, zero), one, fall)), one));  // of the way
    const F x = hn::Add(at, at), s0 = hn::Min(x, one), s1 = hn::Max(zero, hn::Sub(x, one));
    // Weights and first moments of straight tau in the first stride and the second, from the begin on.
    const F rise0 = hn::Sub(tau[1], tau[0]), rise1 = hn::Sub(tau[2], tau[1]);
    const auto weight = [&](F from, F rise, F s) HWY_ATTR { return hn::Mul(s, mul_add(half, hn::Mul(rise, s), from)); };
    const auto moment = [&](F from, F rise, F s)
                            HWY_ATTR { return hn::Mul(hn::Mul(s, s), mul_add(third, hn::Mul(rise, s), hn::Mul(half, from))); };
    const F w1 = weight(tau[1], rise1, s1), w = hn::Add(weight(tau[0], rise0, s0), w1);
    const F mom = hn::Add(moment(tau[0], rise0, s0), hn::Add(w1, moment(tau[1], rise1, s1)));
    const F all1 = hn::Mul(half, hn::Add(tau[1], tau[2])), all = mul_add(half, hn::Add(tau[0], tau[1]), all1);
    const F all_mom = hn::Add(moment(tau[0], rise0, one), hn::Add(all1, moment(tau[1], rise1, one)));
    const F share = hn::Max(zero, hn::Min(hn::Div(w, hn::Max(all, least)), one)), rest = hn::Sub(one, share);
    const F first = hn::Mul(half, hn::Div(mom, hn::Max(w, least)));  // of the way
    const F second = hn::Mul(half, hn::Div(hn::Sub(all_mom, mom), hn::Max(hn::Sub(all, w), least)));
    const auto mean = [&](F seen0, F back0, F seen2, F back2) HWY_ATTR {
      const F a = mixed(d, seen0, back2, hn::Min(first, one)), b = mixed(d, back0, seen2, hn::Min(second, one));
      return Parabola<D>{mul_add(rest, b, hn::Mul(share, a)), zero, zero};
    };
    StrideLight l;
    l.diffuse = mean(p0.light.diffuse, back0.diffuse, p2.light.diffuse, back2.diffuse);
    l.specular = mean(p0.light.specular, back0.specular, p2.light.specular, back2.specular);
    // The jump, where the turn is not even or what lies before hides more of the end.
    const F jump = hn::Add(apart(p2.light, back2), apart(p0.light, back0));
    const F turn = turn_between(p0.surface, p2.surface);
    l.error = mul_add(jump, mul_add(hn::Set(d, share_hidden), depth, hn::Mul(hn::Set(d, share_uneven), turn)),
                      hn::Mul(turn, hn::Mul(lighting.most_bend(), hn::Set(d, 1.0f / 6))));
    const Fade<D> fade(p0.surface, p2.surface, turn);
    l.error = mul_add(hn::Mul(fade.hollow, hn::Set(d, 2 * share_hollow)), lighting.most_fade(), l.error);
    return l;
  }
  HWY_INLINE void take(const StrideLight& o, hn::Mask<D> which) {
    diffuse.take(o.diffuse, which), specular.take(o.specular, which);
    error = hn::IfThenElse(which, o.error, error);
  }

 private:
  static constexpr float lobe_share = 0.05f, share_least = 1.0f / 64, share_turned = 1.0f / 128, share_kinked = 1.0f / 4;
  static constexpr float share_hollow = 1.0f / 3, share_hidden_half = 1.0f / 24, share_angle = 0.25f;
  static constexpr float share_uneven = 0.25f, share_hidden = 1.0f / 16;
  /// The mean of an uneven turn beside that of the parabola through its ends and its middle: a tenth of the cube of how uneven, by
  /// quadrature.
  static HWY_INLINE F beside_parabola(const LitPlace<D>& p0, const LitPlace<D>& p2) {
    const D d;
    const F uneven = hn::Sub(hn::Set(d, 1.0f), hn::Mul(hn::Set(d, 2.0f), turned_half_way(p0.surface, p2.surface)));
    return hn::Mul(hn::Mul(hn::Set(d, 0.1f), apart(p0.light, p2.light)), hn::Abs(hn::Mul(uneven, hn::Mul(uneven, uneven))));
  }
  static HWY_INLINE hn::Mask<D> kinked(Int<D> a, Int<D> b) { return hn::RebindMask(D(), hn::Ne(a, b)); }
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
