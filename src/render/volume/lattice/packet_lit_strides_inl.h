// SPDX-License-Identifier: Apache-2.0
// Light along two strides of a packet of rays: known at their ends and between them, a parabola through the three.
#if defined(SG_PACKET_LIT_STRIDES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_LIT_STRIDES_INL_H
#undef SG_PACKET_LIT_STRIDES_INL_H
#else
#define SG_PACKET_LIT_STRIDES_INL_H
#endif

#include "render/volume/lattice/packet_light_inl.h"
#include "render/volume/lattice/packet_shading_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// Light at one place of each ray.
template <class D>
struct LitPlace {
  LitLanes<D> light, other;  ///< on the face that is seen, and on its back
  hn::Vec<D> along;          ///< of the normal and the ray: the cosine
  hn::Vec<D> normal[3];      ///< unit, along the gradient; 0 where there is none
  Int<D> sides;              ///< of Lighting::on_both

  template <class T>
  static HWY_INLINE LitPlace at(const Lighting<D>& lighting, const Source<D, T>& source, const hn::Vec<D> u[3]) {
    const D d;
    const Slope<D> slope = SlopeFinder<D, T>(source, u[0], u[1], u[2]).find();
    const hn::Vec<D> cells[3] = {slope.x, slope.y, slope.z};
    hn::Vec<D> g[3];
    lighting.to_world(cells, g);
    const auto square = Lighting<D>::dot(g, g), length = hn::Sqrt(square);
    const auto per = hn::Div(hn::Set(d, 1.0f), hn::Max(length, hn::Set(d, 1e-30f)));
    LitPlace p;
    p.light = lighting.on_both(g, square, length, p.sides, p.other);
    for (int a = 0; a < 3; ++a) p.normal[a] = hn::Mul(g[a], per);
    p.along = Lighting<D>::dot(p.normal, lighting.ray);
    return p;
  }
  HWY_INLINE LitPlace permuted(Int<D> order) const {
    const D d;
    const auto to = hn::IndicesFromVec(d, order);
    LitPlace p;
    const auto moved = [&](const LitLanes<D>& l) HWY_ATTR {
      return LitLanes<D>{hn::TableLookupLanes(l.diffuse, to), hn::TableLookupLanes(l.specular, to)};
    };
    p.light = moved(light), p.other = moved(other), p.along = hn::TableLookupLanes(along, to);
    for (int a = 0; a < 3; ++a) p.normal[a] = hn::TableLookupLanes(normal[a], to);
    p.sides = hn::BitCast(IntTag<D>(), hn::TableLookupLanes(hn::BitCast(d, sides), to));
    return p;
  }
  HWY_INLINE void take(const LitPlace& o, hn::Mask<D> which) {
    const auto choose = [&](hn::Vec<D>& mine, hn::Vec<D> theirs) HWY_ATTR { mine = hn::IfThenElse(which, theirs, mine); };
    choose(light.diffuse, o.light.diffuse), choose(light.specular, o.light.specular), choose(along, o.along);
    choose(other.diffuse, o.other.diffuse), choose(other.specular, o.other.specular);
    for (int a = 0; a < 3; ++a) normal[a] = hn::IfThenElse(which, o.normal[a], normal[a]);
    sides = hn::IfThenElse(hn::RebindMask(IntTag<D>(), which), o.sides, sides);
  }
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
    return hn::Add(a, hn::Add(hn::Mul(b, x), hn::Mul(c, hn::Add(hn::Mul(x, x), variance))));
  }
};

/// Light along two strides, and what is wrong with it as a share of what they take.
template <class D>
struct StrideLight {
  using F = hn::Vec<D>;
  Parabola<D> diffuse, specular;
  F error;

  /// A straight line between the ends of both. Its error is more than anybody accepts where there is a kink.
  static HWY_INLINE StrideLight straight(const Material& m, const LitPlace<D>& p0, const LitPlace<D>& p2) {
    const D d;
    const F half = hn::Set(d, 0.5f), zero = hn::Zero(d);
    const auto line = [&](F a, F b) HWY_ATTR { return Parabola<D>{hn::Mul(half, hn::Add(a, b)), hn::Mul(half, hn::Sub(b, a)), zero}; };
    StrideLight l{line(p0.light.diffuse, p2.light.diffuse), line(p0.light.specular, p2.light.specular), zero};
    // The square of the angle by which the surface turns is 2 (1 - cos); an arc lies a twelfth of its bend above its chord in the mean.
    const F turn = hn::Sub(hn::Set(d, 1.0f), Lighting<D>::dot(p0.normal, p2.normal));
    l.error = hn::Mul(turn, hn::Set(d, (m.diffuse + m.specular * m.power) / 6));
    l.error = hn::IfThenElse(kinked(p0.sides, p2.sides), hn::Set(d, 1.0f), l.error);
    return l;
  }
  /// A parabola through the ends and the middle.
  static HWY_INLINE StrideLight curved(const Material& m, const LitPlace<D>& p0, const LitPlace<D>& p1, const LitPlace<D>& p2) {
    const D d;
    const F one = hn::Set(d, 1.0f);
    StrideLight l{Parabola<D>::through(p0.light.diffuse, p1.light.diffuse, p2.light.diffuse),
                  Parabola<D>::through(p0.light.specular, p1.light.specular, p2.light.specular), hn::Zero(d)};
    const F turn01 = hn::Sub(one, Lighting<D>::dot(p0.normal, p1.normal)), turn12 = hn::Sub(one, Lighting<D>::dot(p1.normal, p2.normal));
    const F square = hn::Mul(hn::Set(d, 4.0f), hn::Add(turn01, turn12));
    // A lobe exp(-power angle^2 / 2) bends by that much at most, and its fourth derivative is 3 power times its second.
    const F lobe = hn::Mul(square, hn::Set(d, lobe_share * (m.diffuse + m.specular * m.power)));
    const F bend = hn::Max(hn::Mul(hn::Set(d, 2.0f), hn::Add(hn::Abs(l.diffuse.c), hn::Abs(l.specular.c))), lobe);
    const F share = hn::Add(hn::Set(d, share_least), hn::Mul(square, hn::Set(d, share_turned * m.power)));
    const auto kinks = hn::Or(kinked(p0.sides, p1.sides), kinked(p1.sides, p2.sides));
    l.error = hn::Mul(bend, hn::IfThenElse(kinks, hn::Max(share, hn::Set(d, share_kinked)), share));
    return l;
  }
  /// Where the surface turns over between the ends, and nothing else is a kink: each face on its part of the way, lit by a straight line
  /// between what it has at the ends. `tau` at the ends and the middle tells how much is taken on either part.
  static HWY_INLINE StrideLight turned_over(const Material& m, const LitPlace<D>& p0, const LitPlace<D>& p2, const F tau[3], F depth) {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f), third = hn::Set(d, 1.0f / 3), least = hn::Set(d, 1e-30f);
    const F fall = hn::Sub(p0.along, p2.along);
    const F at = hn::Max(zero, hn::Min(hn::Div(p0.along, hn::IfThenElse(hn::Eq(fall, zero), one, fall)), one));  // of the way
    const F x = hn::Add(at, at), s0 = hn::Min(x, one), s1 = hn::Max(zero, hn::Sub(x, one));
    // Weights and first moments of straight tau in the first stride and the second, from the begin on.
    const F rise0 = hn::Sub(tau[1], tau[0]), rise1 = hn::Sub(tau[2], tau[1]);
    const auto weight = [&](F from, F rise, F s) HWY_ATTR { return hn::Mul(s, hn::Add(from, hn::Mul(half, hn::Mul(rise, s)))); };
    const auto moment = [&](F from, F rise, F s)
                            HWY_ATTR { return hn::Mul(hn::Mul(s, s), hn::Add(hn::Mul(half, from), hn::Mul(third, hn::Mul(rise, s)))); };
    const F w1 = weight(tau[1], rise1, s1), w = hn::Add(weight(tau[0], rise0, s0), w1);
    const F mom = hn::Add(moment(tau[0], rise0, s0), hn::Add(w1, moment(tau[1], rise1, s1)));
    const F all1 = hn::Mul(half, hn::Add(tau[1], tau[2])), all = hn::Add(hn::Mul(half, hn::Add(tau[0], tau[1])), all1);
    const F all_mom = hn::Add(moment(tau[0], rise0, one), hn::Add(all1, moment(tau[1], rise1, one)));
    const F share = hn::Max(zero, hn::Min(hn::Div(w, hn::Max(all, least)), one)), rest = hn::Sub(one, share);
    const F first = hn::Mul(half, hn::Div(mom, hn::Max(w, least)));  // of the way
    const F second = hn::Mul(half, hn::Div(hn::Sub(all_mom, mom), hn::Max(hn::Sub(all, w), least)));
    const auto mean = [&](F seen0, F back0, F seen2, F back2) HWY_ATTR {
      const F a = mixed(d, seen0, back2, hn::Min(first, one)), b = mixed(d, back0, seen2, hn::Min(second, one));
      return Parabola<D>{hn::Add(hn::Mul(share, a), hn::Mul(rest, b)), zero, zero};
    };
    StrideLight l = straight(m, p0, p2);
    l.diffuse = mean(p0.light.diffuse, p0.other.diffuse, p2.light.diffuse, p2.other.diffuse);
    l.specular = mean(p0.light.specular, p0.other.specular, p2.light.specular, p2.other.specular);
    // The jump, where the turn is not even or what lies before hides more of the end.
    const F jump = hn::Add(hn::Abs(hn::Sub(p2.light.diffuse, p2.other.diffuse)), hn::Abs(hn::Sub(p0.light.diffuse, p0.other.diffuse)));
    const F turn = hn::Sub(one, Lighting<D>::dot(p0.normal, p2.normal));
    l.error = hn::Add(hn::Mul(turn, hn::Set(d, (m.diffuse + m.specular * m.power) / 6)),
                      hn::Mul(jump, hn::Add(hn::Mul(hn::Set(d, share_uneven), turn), hn::Mul(hn::Set(d, share_hidden), depth))));
    return l;
  }
  HWY_INLINE void take(const StrideLight& o, hn::Mask<D> which) {
    diffuse.take(o.diffuse, which), specular.take(o.specular, which);
    error = hn::IfThenElse(which, o.error, error);
  }

 private:
  static constexpr float lobe_share = 0.05f, share_least = 1.0f / 256, share_turned = 1.0f / 128, share_kinked = 1.0f / 4;
  static constexpr float share_uneven = 0.25f, share_hidden = 1.0f / 16;
  static HWY_INLINE hn::Mask<D> kinked(Int<D> a, Int<D> b) { return hn::RebindMask(D(), hn::Ne(a, b)); }
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
