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

#include "render/volume/lattice/packet_axes_inl.h"

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
    least_ = std::pow(10.0f, -36 / std::max(1.0f, plan.material.power));
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
    l.plan_ = plan_, l.upright_ = upright_, l.least_ = least_, l.intensity_ = intensity_;
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
    const F lobe = hn::Mul(raised(hn::Sub(one, fall)), hn::Max(one, hn::Mul(hn::Set(d, 2 * m.power), fall)));
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

  const Material& material() const { return plan_->material; }

  F ray[3];  ///< directions

 private:
  const PacketPlan* plan_ = nullptr;
  bool upright_ = false;  ///< the axes of the lattice are those of the world
  float intensity_ = 0;   ///< of all lamps
  float least_ = 0;       ///< what is raised to the power of highlights: smaller than this it would be no normal number
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
      const auto reached = hn::Gt(c, zero);
      diffuse = mul_add(intensity, hn::Max(c, zero), diffuse);
      specular = mul_add(intensity, hn::IfThenElseZero(reached, raised(h)), specular);
      if constexpr (tell) {
        *sides = hn::Or(*sides, hn::IfThenElseZero(hn::RebindMask(di, reached), hn::Set(di, 4 << l)));
        *nearest = hn::Max(*nearest, hn::IfThenElseZero(reached, h));
      }
    }
    // Where there is no surface normals may be no numbers.
    const auto some = hn::Gt(s.much, zero);
    const F much = hn::Min(s.much, one);
    const F change = hn::Sub(mul_add(hn::Set(d, m.diffuse), diffuse, hn::Set(d, m.ambient)), one);
    return {hn::IfThenElse(some, mul_add(much, change, one), one),
            hn::IfThenElseZero(some, hn::Mul(much, hn::Mul(hn::Set(d, m.specular), specular)))};
  }

  /// To the power of highlights.
  HWY_INLINE F raised(F h) const {
    int power = int(plan_->material.power);
    if (power == 0) return hn::Set(D(), 1.0f);
    h = hn::Max(h, hn::Set(D(), least_));
    for (; (power & 1) == 0; power >>= 1) h = hn::Mul(h, h);
    F result = h;
    while (power >>= 1) {
      h = hn::Mul(h, h);
      if (power & 1) result = hn::Mul(result, h);
    }
    return result;
  }
};

template <class D, class T, class Axes>
class CellLight {
  using F = hn::Vec<D>;
  using I = Int<D>;

 public:
  HWY_INLINE CellLight(const Lighting<D>& lighting, const Axes& axes) : lighting_(lighting), axes_(axes) {}

  /// What one place on the way gets wrong of the light on all of it where the light bends; it falls with the square of the number of parts.
  /// And by how much it jumps between the ends (a surface that turns over, a lamp that begins to reach it), or may jump forth and back.
  struct Error {
    F bend, jump;
    I sides[2];
  };
  /// The slopes of this cell, of which those that follow speak.
  HWY_INLINE void find(const Source<D, T>& source, const I cell[3], const F from[3], const F way[3]) {
    const D d;
    slopes_.find(axes_, Around<D, T>(source, cell), cell);
    if constexpr (std::is_same_v<T, float>) {
      F g[3];
      gradient(from, way, hn::Zero(d), g);
      if (!hn::AllFalse(d, hn::IsNaN(hn::Add(g[0], hn::Add(g[1], g[2])))))
        slopes_.find_beside_holes(axes_, Around<D, T>(source, cell), cell);
    }
  }
  HWY_INLINE Error error(const Source<D, T>& source, const I cell[3], const F from[3], const F way[3]) {
    const D d;
    const F zero = hn::Zero(d);
    find(source, cell, from, way);
    F g0[3], g1[3], middle[3], nearest[2];
    gradient(from, way, zero, g0);
    gradient(from, way, hn::Set(d, 1.0f), g1), gradient(from, way, hn::Set(d, 0.5f), middle);
    const FieldSurface<D> s0 = lighting_.surface(g0), s1 = lighting_.surface(g1), sm = lighting_.surface(middle);
    Error e;
    const LitLanes<D> l0 = lighting_.on(s0, e.sides[0], nearest[0]), l1 = lighting_.on(s1, e.sides[1], nearest[1]);
    const auto begins = hn::Gt(s0.much, zero), stops = hn::Gt(s1.much, zero), both = hn::And(begins, stops);
    // Where an end has no surface (equal samples around it), there may be one on the way: then the border of that is a jump.
    const auto some = hn::Gt(hn::Max(sm.much, hn::Max(s0.much, s1.much)), zero), border = hn::AndNot(both, some);
    // For an angle a the light bends by a^2 / 24 of its second derivative, with a^2 = 2 (1 - cos a). An even turn is twice those to and
    // from the middle; a rough field may turn there and back.
    const F turn0 = hn::IfThenElseZero(begins, turn_between(s0, sm)), turn1 = hn::IfThenElseZero(stops, turn_between(sm, s1));
    const F halves = hn::Add(turn0, turn1), whole = hn::IfThenElse(both, turn_between(s0, s1), hn::Set(d, at_border));
    const F turn = hn::Max(whole, hn::Add(halves, halves));
    const F faded =
        hn::Mul(hn::Mul(hn::Set(d, 0.5f), hn::Add(Fade<D>(s0, sm, turn0).hollow, Fade<D>(sm, s1, turn1).hollow)), lighting_.most_fade());
    const F bend = hn::Mul(turn, hn::Mul(lighting_.bend(hn::Max(nearest[0], nearest[1]), turn), hn::Set(d, 1.0f / 12)));
    const auto kinked = hn::RebindMask(d, hn::Ne(e.sides[0], e.sides[1]));
    // The middle of an uneven turn is not its mean: by half the square of how uneven, never by more than a tenth.
    const F uneven = hn::Sub(hn::Set(d, 1.0f), hn::Mul(hn::Set(d, 2.0f), turned_half_way(s0, s1)));
    const F off = hn::Mul(apart(l0, l1), hn::Min(hn::Mul(hn::Mul(hn::Set(d, 0.5f), uneven), uneven), hn::Set(d, 0.1f)));
    e.bend = hn::IfThenElseZero(some, hn::Add(hn::Add(bend, faded), hn::IfThenElseZero(both, off)));
    const auto over_edge = hn::Or(hn::And(begins, grazing(s0, sm)), hn::And(stops, grazing(sm, s1)));
    const F over = hn::IfThenElseZero(hn::Or(over_edge, hn::Gt(turn, hn::Set(d, rough))), turn);
    const F jump = hn::IfThenElse(kinked, apart(l0, l1), hn::IfThenElseZero(border, lighting_.most_fade()));
    e.jump = hn::IfThenElseZero(some, hn::Max(over, jump));
    return e;
  }

  static constexpr int quarters = 4, most_jumps = 2 * quarters;

  /// Where the light of the lanes told jumps on the way, ascending; 2 where it does not. Two jumps are found in each quarter, where they
  /// leave another side than the one before them.
  HWY_NOINLINE void jumps(const F from[3], const F way[3], const Error& e, hn::Mask<D> which, F at[most_jumps]) const {
    const D d;
    const F half = hn::Set(d, 0.5f), none = hn::Set(d, 2.0f);
    const auto other = [&](I a, I b) HWY_ATTR { return hn::And(which, hn::RebindMask(d, hn::Ne(a, b))); };
    // Ever smaller parts that begin on one side and end on another.
    const auto first = [&](F begin, F end, I side) HWY_ATTR {
      for (int n = 0; n < 12; ++n) {
        const F middle = hn::Mul(half, hn::Add(begin, end));
        const auto later = hn::RebindMask(d, hn::Eq(sides(from, way, middle), side));
        begin = hn::IfThenElse(later, middle, begin), end = hn::IfThenElse(later, end, middle);
      }
      return end;
    };
    I before = e.sides[0];
    for (int q = 0; q < quarters; ++q) {
      const F begin = hn::Set(d, float(q) / quarters), end = hn::Set(d, float(q + 1) / quarters);
      const I after = q + 1 < quarters ? sides(from, way, end) : e.sides[1];
      at[2 * q] = at[2 * q + 1] = none;
      if (const auto jump = other(before, after); !hn::AllFalse(d, jump)) {
        const F there = first(begin, end, before);
        at[2 * q] = hn::IfThenElse(jump, there, none);
        const I between = sides(from, way, there);
        if (const auto again = hn::And(jump, other(between, after)); !hn::AllFalse(d, again))
          at[2 * q + 1] = hn::IfThenElse(again, first(there, end, between), none);
      }
      before = after;
    }
  }

  /// World gradient at the share s of the way.
  HWY_INLINE void gradient(const F from[3], const F way[3], F s, F out[3]) const {
    F f[3], g[3];
    for (int a = 0; a < 3; ++a) f[a] = mul_add(way[a], s, from[a]);
    for (int a = 0; a < 3; ++a) g[a] = slopes_.along(a, f);
    lighting_.to_world(g, out);
  }
  HWY_INLINE LitLanes<D> at(const F from[3], const F way[3], F s) const {
    F g[3];
    gradient(from, way, s, g);
    return lighting_.on(lighting_.surface(g));
  }

 private:
  HWY_INLINE I sides(const F from[3], const F way[3], F s) const {
    F g[3], nearest;
    I found;
    gradient(from, way, s, g);
    (void)lighting_.on(lighting_.surface(g), found, nearest);
    return found;
  }

  static constexpr float rough = 0.25f;     // 1 - cosine of a turn within a cell from which on jumps are looked for
  static constexpr float at_border = 0.1f;  // what a surface is thought to turn that begins or ends on the way

  const Lighting<D>& lighting_;
  const Axes& axes_;
  typename Axes::template Slopes<T> slopes_;
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
