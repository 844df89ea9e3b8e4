// SPDX-License-Identifier: Apache-2.0
// Light in the cells that the lanes of a packet cross: central differences at the eight corners, gathered once, trilinear between them,
// which is the central difference of the trilinear field itself.
#if defined(SG_PACKET_LIGHT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_LIGHT_INL_H
#undef SG_PACKET_LIGHT_INL_H
#else
#define SG_PACKET_LIGHT_INL_H
#endif

#include "render/volume/lattice/packets_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

template <class D>
struct LitLanes {
  hn::Vec<D> diffuse, specular;
};

/// The lamps of a picture and the rays that they are seen along.
template <class D>
class Lighting {
  using F = hn::Vec<D>;
  using I = Int<D>;

 public:
  HWY_INLINE Lighting(const PacketPlan& plan, const RayPacket& rays) : plan_(plan) {
    const D d;
    for (int a = 0; a < 3; ++a) ray[a] = hn::Load(d, rays.direction[a]);
    if (!plan.volume.shaded) return;
    for (size_t l = 0; l < plan.lamps.size(); ++l) {
      // Half way between the light and the viewer.
      const Vec3 to = plan.lamps[l].direction;
      const F x = hn::Sub(hn::Set(d, float(to.x)), ray[0]), y = hn::Sub(hn::Set(d, float(to.y)), ray[1]),
              z = hn::Sub(hn::Set(d, float(to.z)), ray[2]);
      const F length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
      const F per = hn::IfThenElseZero(hn::Gt(length, hn::Zero(d)), hn::Div(hn::Set(d, 1.0f), length));
      half_[l][0] = hn::Mul(x, per), half_[l][1] = hn::Mul(y, per), half_[l][2] = hn::Mul(z, per);
    }
  }

  static HWY_INLINE F dot(const F a[3], const F b[3]) {
    return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
  }

  /// A gradient of the field per world length, from one per cell.
  HWY_INLINE void to_world(const F g[3], F out[3]) const {
    const D d;
    const auto& m = plan_.volume.shade_plan.to_world;
    for (int a = 0; a < 3; ++a)
      out[a] = hn::Add(hn::Add(hn::Mul(hn::Set(d, m[a][0]), g[0]), hn::Mul(hn::Set(d, m[a][1]), g[1])), hn::Mul(hn::Set(d, m[a][2]), g[2]));
  }

  /// The same with the rays in another order.
  HWY_INLINE Lighting permuted(Int<D> order) const {
    const D d;
    const auto to = hn::IndicesFromVec(d, order);
    Lighting l = *this;
    for (int a = 0; a < 3; ++a) l.ray[a] = hn::TableLookupLanes(ray[a], to);
    for (size_t n = 0; n < plan_.lamps.size(); ++n)
      for (int a = 0; a < 3; ++a) l.half_[n][a] = hn::TableLookupLanes(half_[n][a], to);
    return l;
  }

  /// Light where the field has the world gradient g, of the given length.
  HWY_INLINE LitLanes<D> on(const F g[3], F square, F length) const { return lit<false>(g, square, length, nullptr, nullptr); }

  /// The same, and the light that the other face of the surface would have. `sides` tells on which side of its kinks it is: bit 0 for the
  /// face that is seen, bit 1 for whether there is as much of a surface as can be, then one for every lamp that reaches it.
  HWY_INLINE LitLanes<D> on_both(const F g[3], F square, F length, I& sides, LitLanes<D>& other) const {
    return lit<true>(g, square, length, &sides, &other);
  }
  /// What `sides` differ by where only the face that is seen is another.
  HWY_INLINE I turned_over() const { return hn::Set(IntTag<D>(), 1 | ((1 << plan_.lamps.size()) - 1) << 2); }

  F ray[3];  ///< directions

 private:
  const PacketPlan& plan_;
  F half_[PacketPlan::most_lamps][3];

  template <bool both>
  HWY_INLINE LitLanes<D> lit(const F g[3], F square, F length, I* sides, LitLanes<D>* other) const {
    const D d;
    const IntTag<D> di;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const auto bent = hn::And(hn::Gt(square, zero), hn::Lt(square, hn::Set(d, 1e30f)));
    const F much = hn::Mul(length, hn::Set(d, plan_.edge * plan_.volume.shade_plan.per_scale)), surface = hn::Min(one, much);
    const auto away = hn::Gt(dot(g, ray), zero);
    const F side = hn::Div(hn::IfThenElse(away, hn::Set(d, -1.0f), one), hn::Max(length, hn::Set(d, 1e-30f)));
    const auto bit = [&](auto mask, int n) HWY_ATTR { return hn::IfThenElseZero(hn::RebindMask(di, mask), hn::Set(di, 1 << n)); };
    if constexpr (both) *sides = hn::Or(bit(away, 0), bit(hn::Lt(much, one), 1));
    const Material& m = plan_.material;
    const auto power_of = [&](F h) HWY_ATTR {
      F power = one;
      for (int n = int(m.power); n > 0; n >>= 1, h = hn::Mul(h, h))
        if (n & 1) power = hn::Mul(power, h);
      return power;
    };
    F diffuse = zero, specular = zero, other_diffuse = zero, other_specular = zero;
    for (size_t l = 0; l < plan_.lamps.size(); ++l) {
      const Vec3f to(plan_.lamps[l].direction);
      const F lamp[3] = {hn::Set(d, to.x), hn::Set(d, to.y), hn::Set(d, to.z)};
      const F c = hn::Mul(side, dot(g, lamp)), h = hn::Mul(side, dot(g, half_[l])), intensity = hn::Set(d, plan_.lamps[l].intensity);
      const auto reached = hn::Gt(c, zero);
      diffuse = hn::Add(diffuse, hn::IfThenElseZero(reached, hn::Mul(intensity, c)));
      specular = hn::Add(specular, hn::IfThenElseZero(reached, hn::Mul(intensity, power_of(hn::Max(h, zero)))));
      if constexpr (both) {
        *sides = hn::Or(*sides, bit(reached, 2 + int(l)));
        other_diffuse = hn::Sub(other_diffuse, hn::IfThenElseZero(hn::Not(reached), hn::Mul(intensity, c)));
        other_specular =
            hn::Add(other_specular, hn::IfThenElseZero(hn::Not(reached), hn::Mul(intensity, power_of(hn::Max(hn::Neg(h), zero)))));
      }
    }
    const auto in_all = [&](F by_lamps, F mirrored) HWY_ATTR {
      const F factor = hn::Sub(hn::Add(hn::Set(d, m.ambient), hn::Mul(hn::Set(d, m.diffuse), by_lamps)), one);
      return LitLanes<D>{hn::IfThenElse(bent, hn::Add(one, hn::Mul(surface, factor)), one),
                         hn::IfThenElseZero(bent, hn::Mul(surface, hn::Mul(hn::Set(d, m.specular), mirrored)))};
    };
    if constexpr (both) *other = in_all(other_diffuse, other_specular);
    return in_all(diffuse, specular);
  }
};

template <class D, class T>
class CellLight {
  using F = hn::Vec<D>;
  using I = Int<D>;

 public:
  HWY_INLINE CellLight(const PacketPlan& plan, const Lighting<D>& lighting) : plan_(plan), lighting_(lighting) {}

  /// Differences over the samples before and after each corner, of the cell whose lowest corner lies at `corner`; `corners` by rows.
  HWY_INLINE void cell(const Source<D, T>& s, I corner, const I at[3], const Pair<D> corners[4]) {
    const D d;
    const IntTag<D> di;
    const I zero = hn::Zero(di), one = hn::Set(di, 1);
    // One sample before the cell and one after it, at the border the outermost again.
    const I steps[3] = {one, s.row, s.layer};
    I before[3], after[3];
    for (int a = 0; a < 3; ++a) {
      const auto in_first = hn::Eq(at[a], zero), in_last = hn::Eq(at[a], s.last_cell[a]);
      first_[a] = hn::RebindMask(d, in_first), last_[a] = hn::RebindMask(d, in_last);
      before[a] = hn::IfThenElse(in_first, zero, hn::Neg(steps[a]));
      after[a] = hn::IfThenElse(in_last, steps[a], hn::Add(steps[a], steps[a]));
    }
    const I rows[4] = {corner, hn::Add(corner, s.row), hn::Add(corner, s.layer), hn::Add(corner, hn::Add(s.layer, s.row))};
    F own[8];
    for (int r = 0; r < 4; ++r) own[2 * r] = corners[r].a, own[2 * r + 1] = corners[r].b;
    for (int r = 0; r < 4; ++r) {
      // x: a - (one before), (one after) - b.
      const F lower = s.pair(hn::Add(rows[r], before[0])).a;
      const F upper = s.pair(hn::Sub(hn::Add(rows[r], after[0]), one)).b;
      slope_[0][2 * r] = hn::Sub(own[2 * r + 1], lower), slope_[0][2 * r + 1] = hn::Sub(upper, own[2 * r]);
    }
    for (int k = 0; k < 2; ++k) {
      const Pair<D> lower = s.pair(hn::Add(rows[2 * k], before[1])), upper = s.pair(hn::Add(rows[2 * k], after[1]));
      slope_[1][4 * k] = hn::Sub(own[4 * k + 2], lower.a), slope_[1][4 * k + 1] = hn::Sub(own[4 * k + 3], lower.b);
      slope_[1][4 * k + 2] = hn::Sub(upper.a, own[4 * k]), slope_[1][4 * k + 3] = hn::Sub(upper.b, own[4 * k + 1]);
    }
    for (int j = 0; j < 2; ++j) {
      const Pair<D> lower = s.pair(hn::Add(rows[j], before[2])), upper = s.pair(hn::Add(rows[j], after[2]));
      slope_[2][2 * j] = hn::Sub(own[4 + 2 * j], lower.a), slope_[2][2 * j + 1] = hn::Sub(own[5 + 2 * j], lower.b);
      slope_[2][4 + 2 * j] = hn::Sub(upper.a, own[2 * j]), slope_[2][5 + 2 * j] = hn::Sub(upper.b, own[2 * j + 1]);
    }
  }

  /// A bound on what one place on the way gets wrong of the light on all of it, where `weight` of the light is taken.
  HWY_INLINE F error(const F from[3], const F way[3], F weight) const {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    F g0[3], g1[3];
    gradient(from, way, zero, g0), gradient(from, way, one, g1);
    const F s0 = Lighting<D>::dot(g0, g0), s1 = Lighting<D>::dot(g1, g1);
    const F both = hn::Sqrt(hn::Mul(s0, s1));
    const F c = hn::Div(Lighting<D>::dot(g0, g1), hn::Max(both, hn::Set(d, 1e-30f)));
    // For an angle a the light bends by about (diffuse + specular power) a^2 / 24, with a^2 = 2 (1 - cos a).
    const Material& m = plan_.material;
    F bend = hn::Mul(hn::Sub(one, c), hn::Set(d, (m.diffuse + m.specular * m.power) / 12));
    // Where the surface turns away its other side is lit: a jump.
    const F facing = hn::Mul(Lighting<D>::dot(g0, lighting_.ray), Lighting<D>::dot(g1, lighting_.ray));
    bend = hn::Add(bend, hn::IfThenElseZero(hn::Lt(facing, zero), hn::Set(d, 0.25f)));
    return hn::Mul(weight, hn::IfThenElseZero(hn::Gt(both, zero), bend));
  }

  HWY_INLINE LitLanes<D> at(const F from[3], const F way[3], F s) const {
    F g[3];
    gradient(from, way, s, g);
    const F square = Lighting<D>::dot(g, g);
    return lighting_.on(g, square, hn::Sqrt(square));
  }

 private:
  /// World gradient at the share s of the way.
  HWY_INLINE void gradient(const F from[3], const F way[3], F s, F out[3]) const {
    const D d;
    const F one = hn::Set(d, 1.0f);
    F f[3], g[3];
    for (int a = 0; a < 3; ++a) f[a] = hn::Add(from[a], hn::Mul(way[a], s));
    for (int a = 0; a < 3; ++a) {
      const F* c = slope_[a];
      const F sum = mixed(d, mixed(d, mixed(d, c[0], c[1], f[0]), mixed(d, c[2], c[3], f[0]), f[1]),
                          mixed(d, mixed(d, c[4], c[5], f[0]), mixed(d, c[6], c[7], f[0]), f[1]), f[2]);
      // Two cells apart, less at the border.
      const F apart = hn::Add(hn::IfThenElse(first_[a], f[a], one), hn::IfThenElse(last_[a], hn::Sub(one, f[a]), one));
      g[a] = hn::Div(sum, apart);
    }
    lighting_.to_world(g, out);
  }

  const PacketPlan& plan_;
  const Lighting<D>& lighting_;
  F slope_[3][8];
  hn::Mask<D> first_[3], last_[3];
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
