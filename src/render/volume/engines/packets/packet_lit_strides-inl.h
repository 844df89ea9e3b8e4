// SPDX-License-Identifier: Apache-2.0
// Light along two strides of a packet of rays: known at their ends and between them, a parabola through the three.
#if defined(SG_PACKET_LIT_STRIDES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_LIT_STRIDES_INL_H
#undef SG_PACKET_LIT_STRIDES_INL_H
#else
#define SG_PACKET_LIT_STRIDES_INL_H
#endif

#include "render/volume/engines/packets/packet_light-inl.h"
#include "render/volume/engines/packets/packet_slopes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// Light at one place of each ray, on the face that is seen.
template <class D>
struct LitPlace {
  LitLanes<D> light;
  FieldSurface<D> surface;
  Float<D> nearest;  ///< of Lighting::on, as
  Int<D> sides;

  /// Where the field has that slope.
  static HWY_INLINE LitPlace at(const Lighting<D>& lighting, const Slope<D>& slope) {
    const Float<D> cells[3] = {slope.x, slope.y, slope.z};
    Float<D> g[3];
    lighting.to_world(cells, g);
    LitPlace p;
    p.surface = lighting.surface(g), p.light = lighting.on(p.surface, p.sides, p.nearest);
    return p;
  }
  static HWY_INLINE LitPlace none() {
    const auto zero = set(D(), 0);
    return {{zero, zero}, {{zero, zero, zero}, zero, zero}, zero, set(IntTag<D>(), 0)};
  }
  HWY_INLINE LitPlace permuted(Int<D> order) const {
    const D d;
    const auto to = hn::IndicesFromVec(d, order);
    LitPlace p;
    p.each(*this, [&](Float<D>& mine, Float<D> theirs) HWY_ATTR { mine = hn::TableLookupLanes(theirs, to); });
    p.sides = bit_cast(IntTag<D>(), hn::TableLookupLanes(bit_cast(d, sides), to));
    return p;
  }
  HWY_INLINE void take(const LitPlace& o, Mask<D> which) {
    each(o, [&](Float<D>& mine, Float<D> theirs) HWY_ATTR { mine = select(which, theirs, mine); });
    sides = select(which, o.sides, sides);
  }

 private:
  template <class Do>
  HWY_INLINE void each(const LitPlace& o, const Do& act) {
    act(light.diffuse, o.light.diffuse), act(light.specular, o.light.specular);
    for (int a = 0; a < 3; ++a) act(surface.normal[a], o.surface.normal[a]);
    act(surface.along, o.surface.along), act(surface.weight, o.surface.weight), act(nearest, o.nearest);
  }
};

/// How straight the gradient goes along a ray, told from the last places: by what share of its change from one to the next it may leave
/// the straight line between them.
template <class D>
class GradientPath {
  using F = Float<D>;

 public:
  HWY_INLINE GradientPath() : length_(set(D(), 0)), recent_(set(D(), unknown)) {
    for (F& c : change_) c = set(D(), 0);
  }
  /// Told from here, p2, so far away, and the place before. Where there is nothing to compare with, what rough fields do.
  HWY_INLINE F swerve(const LitPlace<D>& here, const LitPlace<D>& p2, F length) const {
    const F ratio = length / max(length_, 1e-30f);
    F change[3], bend[3];
    step(here, p2, change);
    for (int a = 0; a < 3; ++a) bend[a] = neg_mul_add(change_[a], ratio, change[a]);
    // The second derivative s counts by s length^2 / 8 in the middle.
    const F size = max(Lighting<D>::dot(change, change), 1e-30f);
    const F share = length / (4.0f * (length + length_));
    const F off = share * sqrt(Lighting<D>::dot(bend, bend) / size);
    return select(known(), off, unknown);
  }
  /// The same of the places of the last cell, too: the gradient bends at faces, and what is told within a cell knows nothing of the next.
  HWY_INLINE F recent(F swerve) const { return max(swerve, recent_); }
  HWY_INLINE void go(const LitPlace<D>& here, const LitPlace<D>& p2, F length, F swerve, F per_cell, Mask<D> which) {
    F change[3];
    step(here, p2, change);
    for (int a = 0; a < 3; ++a) change_[a] = select(which, change[a], change_[a]);
    length_ = select(which, length, length_);
    const F left = max(set(D(), 0), neg_mul_add(length, per_cell, 1.0f));
    recent_ = select(which, max(swerve, left * recent_), recent_);
  }
  HWY_INLINE void forget(Mask<D> which) { length_ = only(!which, length_), recent_ = select(which, unknown, recent_); }
  /// The lanes in which there is something to compare with.
  HWY_INLINE Mask<D> known() const { return length_ > 0; }

 private:
  static constexpr float unknown = 1.0f / 16;
  static HWY_INLINE void step(const LitPlace<D>& a, const LitPlace<D>& b, F change[3]) {
    for (int i = 0; i < 3; ++i) change[i] = b.surface.normal[i] * b.surface.weight - a.surface.normal[i] * a.surface.weight;
  }
  F change_[3], length_;  // of the gradient, up to here; 0: not known
  F recent_;              // the largest share of the last cell, less the farther away
};

/// a + b x + c x^2 with x = -1, 0, 1 at the three places.
template <class D>
struct Parabola {
  Float<D> a, b, c;
  static HWY_INLINE Parabola through(Float<D> before, Float<D> middle, Float<D> after) {
    const auto half = set(D(), 0.5f);
    return {middle, half * (after - before), half * (before - middle + (after - middle))};
  }
  HWY_INLINE void take(const Parabola& o, Mask<D> which) {
    a = select(which, o.a, a), b = select(which, o.b, b), c = select(which, o.c, c);
  }
  /// The mean over weights around x with that variance.
  HWY_INLINE Float<D> mean(Float<D> x, Float<D> variance) const { return a + mul_add(c, mul_add(x, x, variance), b * x); }
  HWY_INLINE Float<D> slope(Float<D> x) const { return mul_add(c + c, x, b); }
};

/// Light along two strides, and what is wrong with it as a share of what they take.
template <class D>
struct StrideLight {
  using F = Float<D>;
  Parabola<D> diffuse, specular;
  F error;

  /// Between the ends of both as the surface turns, which may `swerve` from that by a share of the change (GradientPath). Its error is more
  /// than anybody accepts where there is a kink.
  static HWY_INLINE StrideLight straight(const Lighting<D>& lighting, const LitPlace<D>& p0, const LitPlace<D>& p2, F swerve) {
    const D d;
    const F turn = turn_between(p0.surface, p2.surface), zero = set(d, 0), one = set(d, 1.0f);
    // Half way the normal has turned by turned_half_way(), and light is that of a surface of this weight.
    const Fade<D> fade(p0.surface, p2.surface, turn);
    const F per = fade.middle / max(p0.surface.weight + p2.surface.weight, 1e-30f);
    const F share0 = per * max(one, p0.surface.weight), share2 = per * max(one, p2.surface.weight);
    const auto between = [&](F a, F b, F flat)
                             HWY_ATTR { return Parabola<D>::through(a, mul_add(share0, a - flat, mul_add(share2, b - flat, flat)), b); };
    StrideLight l{between(p0.light.diffuse, p2.light.diffuse, one), between(p0.light.specular, p2.light.specular, zero), zero};
    // The square of the angle by which the surface turns is 2 (1 - cos); an arc lies a twelfth of its bend above its chord in the mean.
    l.error = turn * (lighting.bend(max(p0.nearest, p2.nearest), turn) * (1.0f / 6));
    l.error = mul_add(fade.hollow * share_hollow, lighting.most_fade(), l.error);
    l.error = l.error + beside_parabola(p0, p2);
    // Where the light at both ends is alike it may have been another in between, by the angle.
    const F angle = sqrt(max(zero, turn + turn));
    const F astray = max(apart(p0.light, p2.light), share_angle * angle);
    l.error = mul_add(astray, 2.0f / 3 * swerve, l.error);
    l.error = select(kinked(p0.sides, p2.sides), 1.0f, l.error);
    return l;
  }
  /// A parabola through the ends and the middle of strides of this optical depth, of which the gradient may go `astray` (grazing).
  static HWY_INLINE StrideLight curved(const Lighting<D>& lighting, const LitPlace<D>& p0, const LitPlace<D>& p1, const LitPlace<D>& p2,
                                       F depth, F astray) {
    const D d;
    StrideLight l{Parabola<D>::through(p0.light.diffuse, p1.light.diffuse, p2.light.diffuse),
                  Parabola<D>::through(p0.light.specular, p1.light.specular, p2.light.specular), set(d, 0)};
    const F turn01 = turn_between(p0.surface, p1.surface), turn12 = turn_between(p1.surface, p2.surface);
    const F square = 4.0f * (turn01 + turn12);
    // The fourth derivative of a highlight is 3 power times its second.
    const F nearest = max(p1.nearest, max(p0.nearest, p2.nearest));
    const F lobe = square * (lobe_share * lighting.bend(nearest, max(turn01, turn12)));
    const F bend = max(2.0f * (abs(l.diffuse.c) + abs(l.specular.c)), lobe);
    // What lies beside it before the middle and after cancels, but where the front hides the back.
    const F hidden = mul_add(min(depth, 4.0f), share_hidden_half, share_least);
    const F share = mul_add(square, share_turned * lighting.material().power, hidden);
    // A jump may lie anywhere in its half, which has about half of what is taken.
    const auto jump = [&](const LitPlace<D>& a, const LitPlace<D>& b)
                          HWY_ATTR { return only(kinked(a.sides, b.sides), share_kinked * apart(a.light, b.light)); };
    const F hollows = Fade<D>(p0.surface, p1.surface, turn01).hollow + Fade<D>(p1.surface, p2.surface, turn12).hollow;
    const F faded = hollows * (0.5f * share_hollow) * lighting.most_fade();
    const F aside = faded + beside_parabola(p0, p2);
    l.error = max(bend * share, aside + (jump(p0, p1) + jump(p1, p2)));
    // Between places on one side of the surface's edge, but so near to it, the other may be seen.
    const auto there_and_back = [&](const LitPlace<D>& a, const LitPlace<D>& b)
                                    HWY_ATTR { return grazing(a.surface, b.surface, 0.5f * astray) & !kinked(a.sides, b.sides); };
    l.error = select(there_and_back(p0, p1) | there_and_back(p1, p2), 1.0f, l.error);
    return l;
  }
  /// Of a pair so deep that it is seen to a mean free path into it alone, which is the share `sight` of the way, at p1: a straight line
  /// through there. `astray` as in curved().
  static HWY_INLINE StrideLight front(const LitPlace<D>& p0, const LitPlace<D>& p1, const LitPlace<D>& p2, F sight, F depth, F astray) {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f);
    const F x = sight + sight - one, per = one / max(sight + sight, 1e-6f);
    const auto line = [&](F begin, F seen) HWY_ATTR {
      const F rise = (seen - begin) * per;
      return Parabola<D>{neg_mul_add(rise, x, seen), rise, zero};
    };
    StrideLight l{line(p0.light.diffuse, p1.light.diffuse), line(p0.light.specular, p1.light.specular), zero};
    // Where light turns from one straight line to another, y mean free paths into it, the weighted mean lies beside it by what the two rise
    // by in one more, times exp(-y) - 1 + y: up to 0.37 before the place that is seen, half of that in the mean.
    l.error = share_front * (apart(p0.light, p1.light) + apart(p1.light, p2.light) / max(depth - one, one));
    l.error = l.error + only(kinked(p0.sides, p1.sides), share_kinked * apart(p0.light, p1.light));
    l.error = select(grazing(p0.surface, p1.surface, 0.5f * astray) & !kinked(p0.sides, p1.sides), 1.0f, l.error);
    return l;
  }
  /// Where the surface turns over between the ends, and nothing else is a kink: each face on its part of the way, lit by a straight line
  /// between what it has at the ends. `sigma_t` at the ends and the middle tells how much is taken on either part; `swerve` as in
  /// straight().
  static HWY_INLINE StrideLight turned_over(const Lighting<D>& lighting, const LitPlace<D>& p0, const LitPlace<D>& p2, const F sigma_t[3],
                                            F depth, F swerve) {
    const D d;
    const LitLanes<D> back0 = lighting.on_back(p0.surface), back2 = lighting.on_back(p2.surface);
    const F zero = set(d, 0), one = set(d, 1.0f), half = set(d, 0.5f), third = set(d, 1.0f / 3), least = set(d, 1e-30f);
    const F rise_0 = p0.surface.along * p0.surface.weight, rise_2 = p2.surface.along * p2.surface.weight;
    const F fall = rise_0 - rise_2;
    const F at = max(zero, min(rise_0 / select(fall == zero, one, fall), one));  // of the way
    const F x = at + at, s0 = min(x, one), s1 = max(zero, x - one);
    // Weights and first moments of straight sigma_t in the first stride and the second, from the begin on.
    const F rise0 = sigma_t[1] - sigma_t[0], rise1 = sigma_t[2] - sigma_t[1];
    const auto weight = [&](F from, F rise, F s) HWY_ATTR { return s * mul_add(half, rise * s, from); };
    const auto moment = [&](F from, F rise, F s) HWY_ATTR { return s * s * mul_add(third, rise * s, half * from); };
    const F w1 = weight(sigma_t[1], rise1, s1), w = weight(sigma_t[0], rise0, s0) + w1;
    const F mom = moment(sigma_t[0], rise0, s0) + (w1 + moment(sigma_t[1], rise1, s1));
    const F all1 = half * (sigma_t[1] + sigma_t[2]), all = mul_add(half, sigma_t[0] + sigma_t[1], all1);
    const F all_mom = moment(sigma_t[0], rise0, one) + (all1 + moment(sigma_t[1], rise1, one));
    const F share = max(zero, min(w / max(all, least), one)), rest = one - share;
    const F first = half * (mom / max(w, least));  // of the way
    const F second = half * ((all_mom - mom) / max(all - w, least));
    const auto mean = [&](F seen0, F back0, F seen2, F back2) HWY_ATTR {
      const F a = mixed(d, seen0, back2, min(first, one)), b = mixed(d, back0, seen2, min(second, one));
      return Parabola<D>{mul_add(rest, b, share * a), zero, zero};
    };
    StrideLight l;
    l.diffuse = mean(p0.light.diffuse, back0.diffuse, p2.light.diffuse, back2.diffuse);
    l.specular = mean(p0.light.specular, back0.specular, p2.light.specular, back2.specular);
    // The jump, where the turn is not even or what lies before hides more of the end; and elsewhere, as the gradient leaves its line.
    const F jump = apart(p2.light, back2) + apart(p0.light, back0);
    const F turn = turn_between(p0.surface, p2.surface);
    const F apart_0_2 = p0.surface.weight - p2.surface.weight;
    const F change = sqrt(max(zero, mul_add(apart_0_2, apart_0_2, p0.surface.weight * p2.surface.weight * (turn + turn))));
    const F beside = half * min(one, swerve * change / max(abs(fall), least));
    l.error = mul_add(jump, mul_add(share_hidden, depth, mul_add(share_uneven, turn, beside)), turn * (lighting.most_bend() * (1.0f / 6)));
    const Fade<D> fade(p0.surface, p2.surface, turn);
    l.error = mul_add(fade.hollow * (2 * share_hollow), lighting.most_fade(), l.error);
    return l;
  }
  HWY_INLINE void take(const StrideLight& o, Mask<D> which) {
    diffuse.take(o.diffuse, which), specular.take(o.specular, which);
    error = select(which, o.error, error);
  }

 private:
  static constexpr float lobe_share = 0.05f, share_least = 1.0f / 64, share_turned = 1.0f / 128, share_kinked = 1.0f / 4;
  static constexpr float share_hollow = 1.0f / 3, share_hidden_half = 1.0f / 24, share_angle = 0.25f;
  static constexpr float share_uneven = 0.25f, share_hidden = 1.0f / 16, share_front = 0.25f;
  /// The mean of an uneven turn beside that of the parabola through its ends and its middle: a tenth of the cube of how uneven, by
  /// quadrature.
  static HWY_INLINE F beside_parabola(const LitPlace<D>& p0, const LitPlace<D>& p2) {
    const F uneven = 1.0f - 2.0f * turned_half_way(p0.surface, p2.surface);
    return 0.1f * apart(p0.light, p2.light) * abs(uneven * (uneven * uneven));
  }
  static HWY_INLINE Mask<D> kinked(Int<D> a, Int<D> b) { return rebind(D(), a != b); }
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
