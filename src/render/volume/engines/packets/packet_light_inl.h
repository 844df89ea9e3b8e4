// SPDX-License-Identifier: Apache-2.0
// Light in the cells that the lanes of a packet cross: central differences at the eight corners, gathered once, trilinear between them,
// which is the central difference of the trilinear field itself.
#if defined(SG_PACKET_LIGHT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_LIGHT_INL_H
#undef SG_PACKET_LIGHT_INL_H
#else
#define SG_PACKET_LIGHT_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "render/shade/blinn_phong-inl.h"
#include "render/volume/engines/packets/packet_axes_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

template <class D>
struct LitLanes {
  hn::Vec<D> diffuse, specular;
};

/// By how much light differs.
template <class D>
HWY_INLINE hn::Vec<D> apart(const LitLanes<D>& x, const LitLanes<D>& y) {
  return hn::Add(hn::Abs(hn::Sub(x.diffuse, y.diffuse)), hn::Abs(hn::Sub(x.specular, y.specular)));
}

/// Where a field has a gradient: a surface, seen along a ray.
template <class D>
struct FieldSurface {
  hn::Vec<D> normal[3];  ///< unit, along the gradient
  hn::Vec<D> along;      ///< of the normal and the ray: the cosine
  hn::Vec<D> much;       ///< 0 where there is none (no gradient, or one beyond numbers), 1 and more where it is all surface

  HWY_INLINE void take(const FieldSurface& o, hn::Mask<D> which) {
    for (int a = 0; a < 3; ++a) normal[a] = hn::IfThenElse(which, o.normal[a], normal[a]);
    along = hn::IfThenElse(which, o.along, along), much = hn::IfThenElse(which, o.much, much);
  }
};

/// 1 - cosine of the angle by which the surface turns from one place to another.
template <class D>
HWY_INLINE hn::Vec<D> turn_between(const FieldSurface<D>& a, const FieldSurface<D>& b) {
  const hn::Vec<D> cosine = mul_add(a.normal[2], b.normal[2], mul_add(a.normal[1], b.normal[1], hn::Mul(a.normal[0], b.normal[0])));
  return hn::Sub(hn::Set(D(), 1.0f), cosine);
}
/// Where the gradient goes straight it turns fastest where it is small: half way it has turned by this share, if it began at 0.
template <class D>
HWY_INLINE hn::Vec<D> turned_half_way(const FieldSurface<D>& a, const FieldSurface<D>& b) {
  const D d;
  return hn::Div(b.much, hn::Max(hn::Add(a.much, b.much), hn::Set(d, 1e-30f)));
}

/// How much of a surface there is between two places where the gradient goes straight: around a place without one it fades
/// (FieldSurface::much), and a ray that passes by there may end in as much as it began.
template <class D>
struct Fade {
  hn::Vec<D> middle;  ///< half way, 1 at most
  hn::Vec<D> hollow;  ///< by how much less there is somewhere than a straight line between the ends would have it

  HWY_INLINE Fade(const FieldSurface<D>& a, const FieldSurface<D>& b, hn::Vec<D> turn) {
    using F = hn::Vec<D>;
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f), least = hn::Set(d, 1e-30f);
    middle = one, hollow = zero;
    // The triangle of both gradients is at least as high as it would be if both were as the smaller one.
    const F smaller = hn::Min(a.much, b.much);
    const auto fading = hn::Lt(hn::Mul(hn::Mul(smaller, smaller), neg_mul_add(half, turn, one)), one);
    if (hn::AllFalse(d, fading)) return;
    const F aa = hn::Mul(a.much, a.much), bb = hn::Mul(b.much, b.much), ab = hn::Mul(hn::Mul(a.much, b.much), hn::Sub(one, turn));
    const F ends = hn::Mul(half, hn::Add(hn::Min(a.much, one), hn::Min(b.much, one)));
    const F half_way = hn::Min(one, hn::Mul(half, hn::Sqrt(hn::Max(zero, hn::Add(hn::Add(aa, bb), hn::Add(ab, ab))))));
    // The nearest to nothing, where that lies between: the height of that triangle.
    const F square =
        hn::Div(hn::Max(zero, neg_mul_add(ab, ab, hn::Mul(aa, bb))), hn::Max(hn::Sub(hn::Add(aa, bb), hn::Add(ab, ab)), least));
    const F nearest = hn::IfThenElse(hn::Lt(ab, hn::Min(aa, bb)), hn::Sqrt(square), smaller);
    const F dip = hn::Sub(hn::Min(one, smaller), hn::Min(one, nearest));
    middle = hn::IfThenElse(fading, half_way, one);
    hollow = hn::IfThenElseZero(fading, hn::Max(hn::Sub(ends, half_way), dip));
  }
};
/// Is the ray so near to the surface's edge that it may turn over and back between two places?
template <class D>
HWY_INLINE hn::Mask<D> grazing(const FieldSurface<D>& a, const FieldSurface<D>& b) {
  return hn::Lt(hn::Min(hn::Abs(a.along), hn::Abs(b.along)), turn_between(a, b));
}

/// The lamps of a picture and the rays that they are seen along.
template <class D>
class Lighting {
  using F = hn::Vec<D>;
  using I = Int<D>;

 public:
  Lighting() = default;
  HWY_INLINE Lighting(const PacketPlan& plan, const RayPacket& rays) : plan_(&plan) {
    const D d;
    for (int a = 0; a < 3; ++a) ray[a] = hn::Load(d, rays.direction[a]);
    const auto& m = plan.volume.shade_plan.to_world;
    upright_ = m[0][1] == 0 && m[0][2] == 0 && m[1][0] == 0 && m[1][2] == 0 && m[2][0] == 0 && m[2][1] == 0;
    if (!plan.volume.shaded) return;
    power_ = shading::HWY_NAMESPACE::Power(plan.material.power);
    for (size_t l = 0; l < plan.lamps.size(); ++l) {
      intensity_ += plan.lamps[l].intensity;
      // Half way between the light and the viewer.
      const Vec3f to(plan.lamps[l].direction);
      const F h[3] = {hn::Sub(hn::Set(d, to.x), ray[0]), hn::Sub(hn::Set(d, to.y), ray[1]), hn::Sub(hn::Set(d, to.z), ray[2])};
      const F length = hn::Sqrt(dot(h, h));
      const F per = hn::IfThenElseZero(hn::Gt(length, hn::Zero(d)), hn::Div(hn::Set(d, 1.0f), length));
      for (int a = 0; a < 3; ++a) half_[l][a] = hn::Mul(h[a], per);
    }
  }

  static HWY_INLINE F dot(const F a[3], const F b[3]) { return mul_add(a[2], b[2], mul_add(a[1], b[1], hn::Mul(a[0], b[0]))); }

  /// A gradient of the field per world length, from one per cell.
  HWY_INLINE void to_world(const F g[3], F out[3]) const {
    const D d;
    const auto& m = plan_->volume.shade_plan.to_world;
    for (int a = 0; a < 3; ++a) {
      if (upright_) {
        out[a] = hn::Mul(hn::Set(d, m[a][a]), g[a]);
        continue;
      }
      const F row[3] = {hn::Set(d, m[a][0]), hn::Set(d, m[a][1]), hn::Set(d, m[a][2])};
      out[a] = dot(row, g);
    }
  }

  /// The same with the rays in another order.
  HWY_INLINE Lighting permuted(Int<D> order) const {
    const D d;
    const auto to = hn::IndicesFromVec(d, order);
    Lighting l;
    l.plan_ = plan_, l.upright_ = upright_, l.power_ = power_, l.intensity_ = intensity_;
    for (int a = 0; a < 3; ++a) l.ray[a] = hn::TableLookupLanes(ray[a], to);
    for (size_t n = 0; n < plan_->lamps.size(); ++n)
      for (int a = 0; a < 3; ++a) l.half_[n][a] = hn::TableLookupLanes(half_[n][a], to);
    return l;
  }

  /// The surface where the field has this gradient (world); it changes by `over_edge` over an edge of a cell.
  HWY_INLINE FieldSurface<D> surface(const F g[3]) const {
    const F square = dot(g, g), length = hn::Sqrt(square);
    return surface(g, square, length, hn::Mul(length, hn::Set(D(), plan_->edge)));
  }
  HWY_INLINE FieldSurface<D> surface(const F g[3], F over_edge) const {
    const F square = dot(g, g);
    return surface(g, square, hn::Sqrt(square), over_edge);
  }

  /// Light on the face that is seen.
  HWY_INLINE LitLanes<D> on(const FieldSurface<D>& s) const { return lit<false>(s, facing(s), nullptr, nullptr); }
  /// The same; `sides` tells on which side of its kinks the light is: bit 0 for the face that is seen, bit 1 for whether there is as much
  /// of a surface as can be, then one for every lamp that reaches it. `nearest`: the cosine to the nearest middle of a highlight.
  HWY_INLINE LitLanes<D> on(const FieldSurface<D>& s, I& sides, F& nearest) const { return lit<true>(s, facing(s), &sides, &nearest); }
  /// Light on the face that is not seen.
  HWY_INLINE LitLanes<D> on_back(const FieldSurface<D>& s) const { return lit<false>(s, hn::Xor(facing(s), flipped()), nullptr, nullptr); }
  /// What `sides` differ by where only the face that is seen is another.
  HWY_INLINE I turned_over() const { return hn::Set(IntTag<D>(), 1 | ((1 << plan_->lamps.size()) - 1) << 2); }

  /// The second derivative of the light over the angle of the surface, at most, on an arc of `turn` (1 - cosine) from a place that is
  /// `nearest` to the middle of a highlight, or to such a place. A highlight is exp(-p x^2 / 2) at the angle x.
  HWY_INLINE F bend(F nearest, F turn) const {
    const D d;
    const Material& m = plan_->material;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const F away = hn::Sqrt(hn::Max(zero, hn::Sub(one, nearest))), half_arc = hn::Mul(hn::Set(d, 0.5f), hn::Sqrt(hn::Max(zero, turn)));
    const F closest = hn::Max(zero, hn::Sub(away, half_arc)), fall = hn::Mul(closest, closest);
    const F lobe = hn::Mul(power_(hn::Sub(one, fall)), hn::Max(one, hn::Mul(hn::Set(d, 2 * m.power), fall)));
    return mul_add(hn::Set(d, intensity_ * m.specular * m.power), lobe, hn::Set(d, intensity_ * m.diffuse));
  }
  /// The same anywhere.
  HWY_INLINE F most_bend() const {
    return hn::Set(D(), intensity_ * (plan_->material.diffuse + plan_->material.specular * plan_->material.power));
  }

  /// By how much light may differ between where there is a surface and where there is none.
  HWY_INLINE F most_fade() const {
    const Material& m = plan_->material;
    const float flat = std::abs(1 - m.ambient), lit = std::abs(m.ambient + m.diffuse * intensity_ - 1);
    return hn::Set(D(), std::max(flat, lit) + m.specular * intensity_);
  }

  /// By how much light may differ where a surface turns over or a lamp begins to reach it.
  HWY_INLINE F most_jump() const { return hn::Set(D(), intensity_ * (plan_->material.diffuse + plan_->material.specular)); }

  const Material& material() const { return plan_->material; }
  size_t lamps() const { return plan_->lamps.size(); }
  HWY_INLINE void towards(size_t lamp, F out[3]) const {
    const Vec3f to(plan_->lamps[lamp].direction);
    out[0] = hn::Set(D(), to.x), out[1] = hn::Set(D(), to.y), out[2] = hn::Set(D(), to.z);
  }

  F ray[3];  ///< directions

 private:
  const PacketPlan* plan_ = nullptr;
  bool upright_ = false;                 ///< the axes of the lattice are those of the world
  float intensity_ = 0;                  ///< of all lamps
  shading::HWY_NAMESPACE::Power power_;  ///< of highlights
  F half_[PacketPlan::most_lamps][3];

  static HWY_INLINE F flipped() { return hn::SignBit(D()); }
  /// The sign bit where the normal points away from the viewer: then the other face is seen.
  static HWY_INLINE F facing(const FieldSurface<D>& s) { return hn::IfThenElseZero(hn::Gt(s.along, hn::Zero(D())), flipped()); }

  HWY_INLINE FieldSurface<D> surface(const F g[3], F square, F length, F over_edge) const {
    const D d;
    const F per = hn::Div(hn::Set(d, 1.0f), hn::Max(length, hn::Set(d, 1e-30f)));
    FieldSurface<D> s;
    for (int a = 0; a < 3; ++a) s.normal[a] = hn::Mul(g[a], per);
    s.along = dot(s.normal, ray);
    const auto some = hn::And(hn::Gt(square, hn::Zero(d)), hn::Lt(square, hn::Set(d, 1e30f)));
    s.much = hn::IfThenElseZero(some, hn::Mul(over_edge, hn::Set(d, plan_->volume.shade_plan.per_scale)));
    return s;
  }

  template <bool tell>
  HWY_INLINE LitLanes<D> lit(const FieldSurface<D>& s, F flip, I* sides, F* nearest) const {
    const D d;
    const IntTag<D> di;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    if constexpr (tell) {
      const auto bit = [&](auto mask, int n) HWY_ATTR { return hn::IfThenElseZero(hn::RebindMask(di, mask), hn::Set(di, 1 << n)); };
      *sides = hn::Or(bit(hn::Gt(s.along, zero), 0), bit(hn::Lt(s.much, one), 1));
      *nearest = zero;
    }
    const Material& m = plan_->material;
    F diffuse = zero, specular = zero;
    for (size_t l = 0; l < plan_->lamps.size(); ++l) {
      const Vec3f to(plan_->lamps[l].direction);
      const F lamp[3] = {hn::Set(d, to.x), hn::Set(d, to.y), hn::Set(d, to.z)};
      const F c = hn::Xor(flip, dot(s.normal, lamp)), h = hn::Xor(flip, dot(s.normal, half_[l]));
      const F intensity = hn::Set(d, plan_->lamps[l].intensity);
      const auto terms = shading::HWY_NAMESPACE::lamp_terms(c, h, power_);
      diffuse = mul_add(intensity, terms.diffuse, diffuse);
      specular = mul_add(intensity, terms.specular, specular);
      if constexpr (tell) {
        *sides = hn::Or(*sides, hn::IfThenElseZero(hn::RebindMask(di, terms.reached), hn::Set(di, 4 << l)));
        *nearest = hn::Max(*nearest, hn::IfThenElseZero(terms.reached, h));
      }
    }
    // Where there is no surface normals may be no numbers.
    const auto some = hn::Gt(s.much, zero);
    const F much = hn::Min(s.much, one);
    const F change = hn::Sub(mul_add(hn::Set(d, m.diffuse), diffuse, hn::Set(d, m.ambient)), one);
    return {hn::IfThenElse(some, mul_add(much, change, one), one),
            hn::IfThenElseZero(some, hn::Mul(much, hn::Mul(hn::Set(d, m.specular), specular)))};
  }
};

template <class D, class T, class Axes>
class CellLight {
  using F = hn::Vec<D>;
  using I = Int<D>;

 public:
  HWY_INLINE CellLight(const Lighting<D>& lighting, const Axes& axes) : lighting_(lighting), axes_(axes) {}

  /// What one place on the way gets wrong of the light on all of it where the light bends; it falls with the square of the number of parts.
  /// By how much it changes on the way. And by how much it may jump (a surface turns over, a lamp begins to reach it).
  struct Error {
    F bend, change, jump;
    bool over;                             ///< may it turn over in any lane?
    bool reached[PacketPlan::most_lamps];  ///< may a lamp begin to reach it?
    hn::Mask<D> begins;                    ///< the lanes in which it may become or cease to be as much of a surface as can be
  };
  /// The gradient on the way, of which those that follow speak.
  HWY_INLINE void find(const Source<D, T>& source, const I cell[3], const F from[3], const F way[3]) {
    const D d;
    typename Axes::template Slopes<T> slopes;
    slopes.find(axes_, Around<D, T>(source, cell), cell);
    take(slopes, from, way);
    if constexpr (std::is_same_v<T, float>)
      if (!hn::AllFalse(d, hn::IsNaN(hn::Add(gradient_[0].a, hn::Add(gradient_[1].a, gradient_[2].a))))) {
        slopes.find_beside_holes(axes_, Around<D, T>(source, cell), cell);
        take(slopes, from, way);
      }
  }
  HWY_INLINE Error error(const Source<D, T>& source, const I cell[3], const F from[3], const F way[3]) {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
    find(source, cell, from, way);
    F g0[3], g1[3], middle[3], nearest[3];
    gradient(zero, g0), gradient(one, g1), gradient(half, middle);
    const FieldSurface<D> s0 = lighting_.surface(g0), s1 = lighting_.surface(g1), sm = lighting_.surface(middle);
    I sides[3];
    const LitLanes<D> l0 = lighting_.on(s0, sides[0], nearest[0]), l1 = lighting_.on(s1, sides[1], nearest[1]),
                      lm = lighting_.on(sm, sides[2], nearest[2]);
    const auto begins = hn::Gt(s0.much, zero), stops = hn::Gt(s1.much, zero), both = hn::And(begins, stops);
    // Where an end has no surface (equal samples around it), there may be one on the way: then the border of that is a jump.
    const auto some = hn::Gt(hn::Max(sm.much, hn::Max(s0.much, s1.much)), zero), border = hn::AndNot(both, some);
    const F turn0 = hn::IfThenElseZero(begins, turn_between(s0, sm)), turn1 = hn::IfThenElseZero(stops, turn_between(sm, s1));
    // For an angle a that is turned evenly the light bends by a^2 / 24 of its second derivative; a^2 = 2 (1 - cos a).
    const F turned = hn::Add(hn::IfThenElse(begins, swept(g0, middle, turn0), hn::Set(d, at_border)),
                             hn::IfThenElse(stops, swept(middle, g1, turn1), hn::Set(d, at_border)));
    const F faded = hn::Mul(hn::Mul(half, hn::Add(Fade<D>(s0, sm, turn0).hollow, Fade<D>(sm, s1, turn1).hollow)), lighting_.most_fade());
    const F turn = hn::Max(turn0, turn1), near = hn::Max(nearest[2], hn::Max(nearest[0], nearest[1]));
    const F bend = hn::Mul(turned, hn::Mul(lighting_.bend(near, turn), hn::Set(d, 1.0f / 24)));
    Error e;
    e.change = hn::IfThenElseZero(some, hn::Add(apart(l0, lm), apart(lm, l1)));
    const auto same = [&](F towards[3]) HWY_ATTR {
      F lo, hi;
      along(towards).hull(lo, hi);
      return hn::Or(hn::Gt(lo, zero), hn::Lt(hi, zero));
    };
    F ray[3] = {lighting_.ray[0], lighting_.ray[1], lighting_.ray[2]};
    const auto whole = hn::MaskFromVec(hn::BitCast(d, hn::Set(IntTag<D>(), -1)));
    hn::Mask<D> kinked = hn::AndNot(same(ray), whole);
    e.over = !hn::AllFalse(d, hn::And(some, kinked));
    for (size_t l = 0; l < lighting_.lamps(); ++l) {
      F lamp[3];
      lighting_.towards(l, lamp);
      const auto changes = hn::AndNot(same(lamp), whole);
      e.reached[l] = !hn::AllFalse(d, hn::And(some, changes));
      kinked = hn::Or(kinked, changes);
    }
    // Light on a turn that is not even bends by that, too: by a sixth of its second difference in the mean, twice that where it bends most.
    const auto second = [&](F a, F b, F c) HWY_ATTR { return hn::Abs(hn::Sub(hn::Add(a, c), hn::Add(b, b))); };
    const F bent =
        hn::Mul(hn::Add(second(l0.diffuse, lm.diffuse, l1.diffuse), second(l0.specular, lm.specular, l1.specular)), hn::Set(d, 1.0f / 3));
    const F uneven = hn::IfThenElse(kinked, hn::Mul(e.change, hn::Set(d, 0.1f)), bent);
    e.bend = hn::IfThenElseZero(some, hn::Add(hn::Add(bend, faded), uneven));
    const I differ = hn::Or(hn::Xor(sides[0], sides[2]), hn::Xor(sides[2], sides[1]));
    e.begins = hn::And(some, hn::RebindMask(d, hn::Ne(hn::And(differ, hn::Set(IntTag<D>(), 2)), hn::Zero(IntTag<D>()))));
    const F jump = hn::Max(hn::IfThenElseZero(kinked, lighting_.most_jump()),
                           hn::Max(hn::IfThenElseZero(e.begins, e.change), hn::IfThenElseZero(border, lighting_.most_fade())));
    e.jump = hn::IfThenElseZero(some, jump);
    return e;
  }

  /// Room for all of them, so that no lane goes short because of another: three for the face that is seen and for each lamp.
  static constexpr int quarters = 4, most_jumps = 3 * (1 + int(PacketPlan::most_lamps)) + quarters;

  /// Where the light of the lanes told jumps on the way; 2 in lanes where it does not. Returns how many.
  HWY_NOINLINE int jumps(const Error& e, hn::Mask<D> which, F at[most_jumps]) const {
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
    const auto begins = hn::And(which, e.begins);
    if (hn::AllFalse(d, begins)) return n;
    // Ever smaller parts on whose ends there is as much of a surface as can be, or is not.
    const F half = hn::Set(d, 0.5f), one = hn::Set(d, 1.0f);
    const auto all = [&](F s) HWY_ATTR {
      F g[3];
      gradient(s, g);
      return hn::Ge(lighting_.surface(g).much, one);
    };
    auto before = all(hn::Zero(d));
    for (int q = 0; q < quarters; ++q) {
      F begin = hn::Set(d, float(q) / quarters), end = hn::Set(d, float(q + 1) / quarters);
      const auto after = all(end), changes = hn::And(begins, hn::Xor(before, after));
      if (!hn::AllFalse(d, changes)) {
        for (int i = 0; i < 12; ++i) {
          const F middle = hn::Mul(half, hn::Add(begin, end));
          const auto earlier = hn::Xor(all(middle), before);
          end = hn::IfThenElse(earlier, middle, end), begin = hn::IfThenElse(earlier, begin, middle);
        }
        at[n++] = hn::IfThenElse(changes, end, hn::Set(d, 2.0f));
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
  static HWY_INLINE void roots(const Cubic<D>& h, hn::Mask<D> which, F at[most_jumps], int& n) {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    F turn[2];
    h.turns(turn[0], turn[1]);
    for (F& t : turn) t = hn::IfThenElseZero(hn::And(hn::Gt(t, zero), hn::Lt(t, one)), t);
    const F ends[4] = {zero, hn::Min(turn[0], turn[1]), hn::Max(turn[0], turn[1]), one};
    F before = h.a;
    for (int i = 0; i < 3; ++i) {
      const F after = i < 2 ? h.at(ends[i + 1]) : h.last;
      const auto changes = hn::And(which, hn::Xor(hn::Gt(before, zero), hn::Gt(after, zero)));
      if (!hn::AllFalse(d, changes))
        at[n++] = hn::IfThenElse(changes, h.zero_between(ends[i], ends[i + 1], before, after), hn::Set(d, 2.0f));
      before = after;
    }
  }
  /// The square of the angle that is turned over half of the way from one gradient to the next, as if it were turned evenly over all of it:
  /// it is turned fastest where the gradient is smallest. `turn`: 1 - cosine.
  static HWY_INLINE F swept(const F a[3], const F b[3], F turn) {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f), least = hn::Set(d, 1e-30f);
    const F c[3] = {hn::Sub(b[0], a[0]), hn::Sub(b[1], a[1]), hn::Sub(b[2], a[2])};
    const F change = hn::Max(Lighting<D>::dot(c, c), least);
    const F to = hn::Max(zero, hn::Min(hn::Div(hn::Neg(Lighting<D>::dot(a, c)), change), one));
    const F near[3] = {mul_add(c[0], to, a[0]), mul_add(c[1], to, a[1]), mul_add(c[2], to, a[2])};
    const F smallest = hn::Max(Lighting<D>::dot(near, near), hn::Mul(change, hn::Set(d, 1 / (most_rate * most_rate))));
    const F even = hn::Add(turn, turn);  // the square of the angle
    return hn::Mul(two, hn::Sqrt(hn::Mul(even, hn::Max(even, hn::Div(change, smallest)))));
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
