// SPDX-License-Identifier: Apache-2.0
// Light in the cells that the lanes of a packet cross: central differences at the eight corners, gathered once, trilinear between them,
// which is the central difference of the trilinear field itself; along a ray a cubic. With bounds on how far the light bends, changes and
// jumps on the way, and the places where it jumps.
#if defined(SG_PACKET_CELL_LIGHT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_CELL_LIGHT_INL_H
#undef SG_PACKET_CELL_LIGHT_INL_H
#else
#define SG_PACKET_CELL_LIGHT_INL_H
#endif

#include "render/volume/engines/packets/packet_light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// The light on the way through a cell each.
template <class D, class T, class Axes>
class CellLight {
  using F = Float<D>;
  using I = Int<D>;

 public:
  HWY_INLINE CellLight(const Lighting<D>& lighting, const Axes& axes) : lighting_(lighting), axes_(axes) {}

  /// What one place on the way gets wrong of the light on all of it where the light bends; it falls with the square of the number of parts.
  /// By how much it changes on the way. And by how much it may jump (a surface turns over, a lamp begins to reach it).
  struct Error {
    F bend, change, jump;
    bool over;                               ///< may it turn over in any lane?
    bool reached[Illumination::most_lamps];  ///< may a lamp begin to reach it?
    Mask<D> begins;                          ///< the lanes in which its weight may pass 1
  };
  /// The gradient on the way, of which those that follow speak.
  HWY_INLINE void find(const Source<D, T>& source, const I cell[3], const F from[3], const F way[3]) {
    typename Axes::template Slopes<T> slopes;
    slopes.find(axes_, Around<D, T>(source, cell), cell);
    take(slopes, from, way);
    if constexpr (std::is_same_v<T, float>)
      if (any(is_nan(gradient_[0].a + (gradient_[1].a + gradient_[2].a)))) {
        slopes.find_beside_holes(axes_, Around<D, T>(source, cell), cell);
        take(slopes, from, way);
      }
  }
  HWY_NOINLINE Error error(const Source<D, T>& source, const I cell[3], const F from[3], const F way[3]) {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f), half = set(d, 0.5f);
    // Gradient, surface and light at both ends and in the middle.
    find(source, cell, from, way);
    F g0[3], g1[3], middle[3], nearest[3];
    gradient(zero, g0), gradient(one, g1), gradient(half, middle);
    const FieldSurface<D> s0 = lighting_.surface(g0), s1 = lighting_.surface(g1), sm = lighting_.surface(middle);
    I sides[3];
    const LitLanes<D> l0 = lighting_.on(s0, sides[0], nearest[0]), l1 = lighting_.on(s1, sides[1], nearest[1]),
                      lm = lighting_.on(sm, sides[2], nearest[2]);
    const auto begins = s0.weight > zero, stops = s1.weight > zero, both = begins & stops;
    // Where an end has no surface (equal samples around it), there may be one on the way: then the border of that is a jump.
    const auto some = max(sm.weight, max(s0.weight, s1.weight)) > zero, border = some & !both;
    const F turn0 = only(begins, turn_between(s0, sm)), turn1 = only(stops, turn_between(sm, s1));
    // For an angle a that is turned evenly the light bends by a^2 / 24 of its second derivative; a^2 = 2 (1 - cos a).
    const F fastest = max(rate_near(zero, g0), max(rate_near(half, middle), rate_near(one, g1)));
    const F turned =
        select(begins, swept(g0, middle, turn0, fastest), at_border) + select(stops, swept(middle, g1, turn1, fastest), at_border);
    const F faded = half * (Fade<D>(s0, sm, turn0).hollow + Fade<D>(sm, s1, turn1).hollow) * lighting_.most_fade();
    const F turn = max(turn0, turn1), near = max(nearest[2], max(nearest[0], nearest[1]));
    const F bend = turned * (lighting_.bend(near, turn) * (1.0f / 24));
    // Kinks: where the surface turns over or a lamp begins to reach it.
    Error e;
    e.change = only(some, apart(l0, lm) + apart(lm, l1));
    const auto same = [&](F towards[3]) HWY_ATTR {
      F lo, hi;
      along(towards).hull(lo, hi);
      return (lo > zero) | (hi < zero);
    };
    F ray[3] = {lighting_.ray[0], lighting_.ray[1], lighting_.ray[2]};
    const auto whole = hn::MaskFromVec(bit_cast(d, set(IntTag<D>(), -1)));
    Mask<D> kinked = whole & !same(ray);
    e.over = any(some & kinked);
    for (size_t l = 0; l < lighting_.lamps(); ++l) {
      F lamp[3];
      lighting_.towards(l, lamp);
      const auto changes = whole & !same(lamp);
      e.reached[l] = any(some & changes);
      kinked = kinked | changes;
    }
    // Light on a turn that is not even bends by that, too: by a sixth of its second difference in the mean, twice that where it bends most.
    const auto second = [&](F a, F b, F c) HWY_ATTR { return abs(a + c - (b + b)); };
    const F bent = (second(l0.diffuse, lm.diffuse, l1.diffuse) + second(l0.specular, lm.specular, l1.specular)) * (1.0f / 3);
    const F uneven = select(kinked, e.change * 0.1f, bent);
    e.bend = only(some, bend + faded + uneven);
    // Jumps: at kinks, where the weight passes 1, and at the border of a surface.
    const I differ = (sides[0] ^ sides[2]) | (sides[2] ^ sides[1]);
    e.begins = some & rebind(d, (differ & 2) != 0);
    const F jump = max(only(kinked, lighting_.most_jump()), max(only(e.begins, e.change), only(border, lighting_.most_fade())));
    e.jump = only(some, jump);
    return e;
  }

  /// Room for all of them, so that no lane goes short because of another: three for the face that is seen and for each lamp.
  static constexpr int quarters = 4, most_jumps = 3 * (1 + int(Illumination::most_lamps)) + quarters;

  /// Where the light of the lanes told jumps on the way; 2 in lanes where it does not. Returns how many.
  HWY_NOINLINE int jumps(const Error& e, Mask<D> which, F at[most_jumps]) const {
    const D d;
    int n = 0;
    const F ray[3] = {lighting_.ray[0], lighting_.ray[1], lighting_.ray[2]};
    if (e.over) roots(along(ray), which, at, n);
    for (size_t l = 0; l < lighting_.lamps(); ++l) {
      if (!e.reached[l]) continue;
      F lamp[3];
      lighting_.towards(l, lamp);
      roots(along(lamp), which, at, n);
    }
    const auto begins = which & e.begins;
    if (none(begins)) return n;
    // Bisection: where the weight passes 1 between two ends.
    const F half = set(d, 0.5f), one = set(d, 1.0f);
    const auto all = [&](F s) HWY_ATTR {
      F g[3];
      gradient(s, g);
      return lighting_.surface(g).weight >= one;
    };
    auto before = all(set(d, 0));
    for (int q = 0; q < quarters; ++q) {
      F begin = set(d, float(q) / quarters), end = set(d, float(q + 1) / quarters);
      const auto after = all(end), changes = begins & (before ^ after);
      if (any(changes)) {
        for (int i = 0; i < 12; ++i) {
          const F middle = half * (begin + end);
          const auto earlier = all(middle) ^ before;
          end = select(earlier, middle, end), begin = select(earlier, begin, middle);
        }
        at[n++] = select(changes, end, 2.0f);
      }
      before = after;
    }
    return n;
  }

  /// World gradient at the share s of the way.
  HWY_INLINE void gradient(F s, F out[3]) const {
    for (int a = 0; a < 3; ++a) out[a] = gradient_[a].at(s);
  }
  HWY_INLINE LitLanes<D> at(F s) const {
    F g[3];
    gradient(s, g);
    return lighting_.on(lighting_.surface(g));
  }

 private:
  template <class Slopes>
  HWY_INLINE void take(const Slopes& slopes, const F from[3], const F way[3]) {
    const Cubic<D> c[3] = {slopes.along(0, from, way), slopes.along(1, from, way), slopes.along(2, from, way)};
    const auto part = [&](F Cubic<D>::*of) HWY_ATTR {
      const F cells[3] = {c[0].*of, c[1].*of, c[2].*of};
      F world[3];
      lighting_.to_world(cells, world);
      for (int a = 0; a < 3; ++a) gradient_[a].*of = world[a];
    };
    part(&Cubic<D>::a), part(&Cubic<D>::b), part(&Cubic<D>::c), part(&Cubic<D>::e), part(&Cubic<D>::last);
  }
  /// The gradient's part along a direction.
  HWY_INLINE Cubic<D> along(const F towards[3]) const {
    return gradient_[0].times(towards[0]).plus(gradient_[1], towards[1]).plus(gradient_[2], towards[2]);
  }
  /// Appends where a cubic changes its sign: between the ends and where it turns.
  static HWY_INLINE void roots(const Cubic<D>& h, Mask<D> which, F at[most_jumps], int& n) {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f);
    F turn[2];
    h.turns(turn[0], turn[1]);
    for (F& t : turn) t = only((t > zero) & (t < one), t);
    const F ends[4] = {zero, min(turn[0], turn[1]), max(turn[0], turn[1]), one};
    F before = h.a;
    for (int i = 0; i < 3; ++i) {
      const F after = i < 2 ? h.at(ends[i + 1]) : h.last;
      const auto changes = which & ((before > zero) ^ (after > zero));
      if (any(changes)) at[n++] = select(changes, h.zero_between(ends[i], ends[i + 1], before, after), 2.0f);
      before = after;
    }
  }
  /// The square of the angle that is turned over half of the way from one gradient to the next, as if it were turned evenly over all of it:
  /// it is turned fastest where the gradient is smallest. `turn`: 1 - cosine. `fastest`: the square of the largest known rate, in radians
  /// over half of the way; a gradient that turns fast and back between the two is told by that alone.
  static HWY_INLINE F swept(const F a[3], const F b[3], F turn, F fastest) {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f), two = set(d, 2.0f), least = set(d, 1e-30f);
    const F c[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const F change = max(Lighting<D>::dot(c, c), least);
    const F to = max(zero, min(-Lighting<D>::dot(a, c) / change, one));
    const F near[3] = {mul_add(c[0], to, a[0]), mul_add(c[1], to, a[1]), mul_add(c[2], to, a[2])};
    const F smallest = max(Lighting<D>::dot(near, near), change * (1 / (most_rate * most_rate)));
    const F even = max(turn + turn, 0.05f * fastest);  // the square of the angle
    return two * sqrt(even * max(even, max(fastest, change / smallest)));
  }
  /// The square of the rate at which the gradient turns, in radians over half of the way, where it comes nearest to nothing as its tangent
  /// at s tells (g: there): |g x g'|^2 / |g|^4.
  HWY_INLINE F rate_near(F s, const F g[3]) const {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f), least = set(d, 1e-30f);
    F rise[3], near[3];
    slope(s, rise);
    const F to = s - Lighting<D>::dot(g, rise) / max(Lighting<D>::dot(rise, rise), least);
    const F at = max(zero, min(to, one));
    gradient(at, near), slope(at, rise);
    const F gg = Lighting<D>::dot(near, near), along = Lighting<D>::dot(near, rise), rr = Lighting<D>::dot(rise, rise);
    const F across = max(zero, neg_mul_add(along, along, gg * rr)) * 0.25f;
    return min(across / max(gg * gg, least), most_rate * most_rate);
  }
  /// How the gradient changes at the share s of the way.
  HWY_INLINE void slope(F s, F out[3]) const {
    for (int a = 0; a < 3; ++a) {
      const Cubic<D>& g = gradient_[a];
      out[a] = mul_add(s, mul_add(3.0f * s, g.e, g.c + g.c), g.b);
    }
  }

  static constexpr float at_border = 0.1f;  // what a surface is thought to turn that begins or ends on the way
  static constexpr float most_rate = 100;   // of a turn over half of the way, in radians

  const Lighting<D>& lighting_;
  const Axes& axes_;
  Cubic<D> gradient_[3];  // world
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
