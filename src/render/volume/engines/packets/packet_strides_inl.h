// SPDX-License-Identifier: Apache-2.0
// Strides along packets of rays: stretches longer than cells, on which the value is as good as straight. What a stride gets wrong is
// bounded by how far the field bends there (Bends) and how steep the medium is over the values met (MediumSums).
#if defined(SG_PACKET_STRIDES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_STRIDES_INL_H
#undef SG_PACKET_STRIDES_INL_H
#else
#define SG_PACKET_STRIDES_INL_H
#endif

#include "render/volume/engines/packets/packets_inl.h"
#include "render/volume/medium/medium_sums.h"
#include "render/volume/sources/lattice/bends.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// MediumSums, ready for gathers.
template <class D>
struct SumLanes {
  using F = hn::Vec<D>;
  using I = Int<D>;
  const MediumSums* sums;
  bool loads;  ///< of gathers.h

  /// The medium at a value: tau, and the integral of tau up to it in two parts.
  struct Place {
    F value, tau, slope, beyond, kinks;
    I node, sum;
  };
  HWY_INLINE Place at(F value) const {
    const D d;
    const IntTag<D> di;
    const F zero = hn::Zero(d), top = hn::Set(d, float(MediumSums::nodes - 1)), lo = hn::Set(d, sums->lo());
    F at = hn::Mul(hn::Sub(value, lo), hn::Set(d, sums->per_width()));
    at = hn::Min(hn::Max(at, zero), top);  // no number: the first
    Place p;
    p.value = value, p.node = to_int(d, at);
    const auto* table = reinterpret_cast<const float*>(sums->table());
    const I entry = hn::ShiftLeft<2>(p.node);
    const auto [sum_tau, slope] = gather_quad(d, table, entry, loads);
    p.sum = hn::BitCast(di, sum_tau.a);
    const F x = neg_mul_add(hn::ConvertTo(d, p.node), hn::Set(d, sums->width()), hn::Sub(value, lo));
    p.slope = slope.a, p.kinks = slope.b;
    const F rise = hn::Mul(x, slope.a);
    p.beyond = hn::Mul(x, mul_add(hn::Set(d, 0.5f), rise, sum_tau.b));
    p.tau = hn::Max(zero, hn::Add(sum_tau.b, rise));
    return p;
  }
  /// The mean of tau over the values between two places; `even` is that of a straight line.
  HWY_INLINE F mean(const Place& a, const Place& b, F even) const {
    const D d;
    const F change = hn::Sub(b.value, a.value);
    const F whole = hn::Mul(hn::ConvertTo(d, hn::Sub(b.sum, a.sum)), hn::Set(d, sums->per_sum()));
    const F all = hn::Add(whole, hn::Sub(b.beyond, a.beyond));
    const auto near = hn::Lt(hn::Abs(change), hn::Set(d, 2 * sums->width()));
    return hn::IfThenElse(near, even, hn::Max(hn::Zero(d), hn::Div(all, hn::IfThenElse(near, hn::Set(d, 1.0f), change))));
  }
  /// The largest |slope| of tau between two places, so many nodes to both sides.
  HWY_INLINE F steepest(const Place& a, const Place& b, I pad) const {
    const D d;
    const IntTag<D> di;
    const hn::RebindToUnsigned<IntTag<D>> du;
    const I lower = hn::Max(hn::Zero(di), hn::Sub(hn::Min(a.node, b.node), pad));
    const I upper = hn::Min(hn::Set(di, MediumSums::nodes - 1), hn::Add(hn::Max(a.node, b.node), pad));
    // 2^level > upper - lower.
    const I exponent = hn::ShiftRight<23>(hn::BitCast(di, hn::ConvertTo(d, hn::Sub(upper, lower))));
    const auto level = hn::BitCast(du, hn::Max(hn::Zero(di), hn::Sub(exponent, hn::Set(di, 126))));
    const auto all = hn::Set(du, uint32_t(2 * MediumSums::nodes));
    const auto first = hn::Sub(all, hn::Shr(all, level));
    const auto entry = hn::BitCast(di, hn::Add(first, hn::Shr(hn::BitCast(du, lower), level)));
    return hn::BitCast(d, gather_words(d, sums->steepest(), hn::ShiftLeft<2>(entry), loads));
  }
  /// As many as the values change by, and one.
  HWY_INLINE I nodes_over(F change) const {
    const D d;
    return hn::Add(to_int(d, hn::Min(hn::Mul(change, hn::Set(d, sums->per_width())), hn::Set(d, float(MediumSums::nodes)))),
                   hn::Set(IntTag<D>(), 1));
  }
};

/// Of what a stride's value may be off, the share that counts (docs/decisions/0007-strides.md). Longer strides would tell too little of how
/// a lit surface turns.
constexpr float share_off = 0.01f, share_off_lit = 0.014f;
/// What a brick allows need not be so on this ray: so much of it counts at least, and this many times what the values met tell.
constexpr float least_off = 0.25f, times_met = 1.5f;

/// What two strides of the same length, one after the other, would bring and get wrong. Places are told from the middle between them on,
/// in strides.
template <class D>
struct Strides {
  hn::Vec<D> depth;             ///< optical
  hn::Vec<D> error;             ///< of the optical depth, and of the share of the light that gets a wrong colour
  hn::Vec<D> ahead;             ///< what more (or less) there would be to get wrong if it went on like the second
  hn::Vec<D> value;             ///< the mean by emission,
  hn::Vec<D> middle, variance;  ///< and where it lies
  hn::Vec<D> change;            ///< largest less smallest value
  hn::Vec<D> uneven;            ///< of a change of colour or light, the share that is hidden otherwise, or lies elsewhere
};

/// From p0 by p1 to p2, each stride `world` long; the slope of the value changes by at most `bend` per cell length, of which a stride has
/// `cells`.
template <bool shaded, class D>
HWY_INLINE Strides<D> strides(const SumLanes<D>& medium, const Medium& colors, float tolerance, const typename SumLanes<D>::Place& p0,
                              const typename SumLanes<D>::Place& p1, const typename SumLanes<D>::Place& p2, hn::Vec<D> world,
                              hn::Vec<D> cells, hn::Vec<D> bend) {
  using F = hn::Vec<D>;
  const D d;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f), third = hn::Set(d, 1.0f / 3);
  const F rise_a = hn::Sub(p1.value, p0.value), rise_b = hn::Sub(p2.value, p1.value);
  const F arch = hn::Sub(rise_b, rise_a);  // the second difference
  const F both_a = hn::Add(p0.tau, p1.tau), both_b = hn::Add(p1.tau, p2.tau);
  const F even_a = hn::Mul(half, both_a), even_b = hn::Mul(half, both_b);
  const F mean_a = medium.mean(p0, p1, even_a), mean_b = medium.mean(p1, p2, even_b);
  const F lo = hn::Min(p0.value, hn::Min(p1.value, p2.value)), hi = hn::Max(p0.value, hn::Max(p1.value, p2.value)),
          change = hn::Sub(hi, lo);
  constexpr float share = shaded ? share_off_lit : share_off;
  // A fourth of it at most, an eighth in the mean. Short strides meet one face of cells at most, where all of a cell's bend may be.
  const F off = hn::Mul(bend, hn::Mul(cells, hn::Max(cells, half)));
  const auto pad = medium.nodes_over(hn::Mul(hn::Set(d, 0.25f), off));
  const F steep_a = medium.steepest(p0, p1, pad), steep_b = medium.steepest(p1, p2, pad);
  // A parabola lies `arch` / 12 below its chord in the mean.
  const F sagging = hn::Mul(hn::Set(d, 1.0f / 24), arch);
  const F depth_a = hn::Max(zero, neg_mul_add(sagging, hn::Add(p0.slope, p1.slope), mean_a));
  const F depth_b = hn::Max(zero, neg_mul_add(sagging, hn::Add(p1.slope, p2.slope), mean_b));
  const F sum = hn::Add(depth_a, depth_b), twice = hn::Add(world, world);
  Strides<D> s;
  s.change = change;
  s.depth = hn::Mul(world, sum);

  // Where a stride's tau goes straight its middle lies between a third and two thirds of it.
  const F least = hn::Set(d, 1e-30f), twice_least = hn::Set(d, 2e-30f);
  const auto share_of = [&](F part, F all) HWY_ATTR { return hn::Div(hn::Add(part, least), hn::Add(all, twice_least)); };
  const F w_a = mul_add(third, share_of(p1.tau, both_a), third), w_b = mul_add(third, share_of(p2.tau, both_b), third);
  const F share_b = share_of(depth_b, sum), share_a = hn::Sub(one, share_b);
  const F from_a = hn::Sub(w_a, one);
  s.middle = mul_add(share_b, w_b, hn::Mul(share_a, from_a));
  s.value = neg_mul_add(hn::Set(d, 1.0f / 12), arch,
                        hn::Add(p1.value, mul_add(hn::Mul(share_b, w_b), rise_b, hn::Mul(hn::Mul(share_a, from_a), rise_a))));
  const auto spread = [&](F w) HWY_ATTR { return neg_mul_add(w, w, hn::Sub(w, hn::Set(d, 1.0f / 6))); };
  const F apart = hn::Sub(w_b, from_a);
  s.variance = mul_add(hn::Mul(share_a, share_b), hn::Mul(apart, apart), mul_add(share_b, spread(w_b), hn::Mul(share_a, spread(w_a))));

  // Colours bend on a width; where tau is no straight line between the ends its middle lies elsewhere, by two thirds of the stride at most;
  // in a deep stride the front shows more of its own colour.
  const F taken = hn::Min(one, s.depth);
  const F recolored = hn::Min(one, hn::Mul(change, hn::Set(d, colors.color_slope())));
  const F widths = hn::Mul(change, hn::Set(d, 1 / colors.color_width()));
  // A constant tau would hide as much of the back as this one by two straight pieces does, but for 1 / 240 of the square of what the depth
  // tilts by, and 1 / 192 of the depth times what it turns by in the middle; and the third order. Twice that, as tau may do more.
  const F tilt = hn::Mul(twice, hn::Abs(hn::Sub(p2.tau, p0.tau))),
          turn = hn::Mul(twice, hn::Abs(hn::Sub(hn::Add(p0.tau, p2.tau), hn::Add(p1.tau, p1.tau))));
  const F tilted = mul_add(hn::Mul(s.depth, s.depth), hn::Set(d, 1.0f / 360), hn::Mul(tilt, hn::Set(d, 1.0f / 120)));
  const F deep = mul_add(tilt, tilted, hn::Mul(s.depth, hn::Mul(turn, hn::Set(d, 1.0f / 96))));
  const F uneven = hn::Mul(hn::Mul(third, world), hn::Add(hn::Abs(hn::Sub(mean_a, even_a)), hn::Abs(hn::Sub(mean_b, even_b))));
  const F counted = hn::Max(hn::Mul(off, hn::Set(d, least_off)), hn::Min(off, hn::Mul(hn::Abs(arch), hn::Set(d, times_met))));
  const F per_steep = hn::Mul(world, hn::Mul(counted, hn::Set(d, share)));
  F e = hn::Mul(per_steep, hn::Add(steep_a, steep_b));
  s.ahead = hn::Mul(per_steep, hn::Sub(steep_b, steep_a));
  e = mul_add(hn::Mul(taken, hn::Set(d, 0.25f * tolerance)), hn::Mul(widths, widths), e);
  s.uneven = hn::Add(hn::Min(one, deep), uneven);
  e = mul_add(recolored, s.uneven, e);
  // Where colours kink they leave the straight line to both ends by up to a fourth of what their slope changes by, an eighth in the mean;
  // a deep pair shows its front alone.
  if (medium.sums->kinked()) {
    const F kinks = hn::Sub(hn::Max(p0.kinks, hn::Max(p1.kinks, p2.kinks)), hn::Min(p0.kinks, hn::Min(p1.kinks, p2.kinks)));
    const F shown = mul_add(hn::Min(s.depth, hn::Set(d, 8.0f)), hn::Set(d, 1.0f / 64), hn::Set(d, 0.125f));
    e = mul_add(hn::Mul(taken, shown), hn::Min(one, hn::Mul(kinks, change)), e);
  }
  // A deep pair shows the ends of a parabola of colours more than its middle: for weights exp(-depth x / 2) the mean of x^2 is
  // 1/3 + depth^2 / 90, and below 1/3 + 4^2 / 90 + 3 (depth - 4) / 100 from 4 on, 1 at most.
  const F deeper = hn::Min(hn::Max(hn::Sub(s.depth, hn::Set(d, 4.0f)), zero), hn::Set(d, 49.0f / 3));
  const F ends = mul_add(deeper, hn::Set(d, 0.03f), hn::Mul(hn::Min(hn::Mul(s.depth, s.depth), hn::Set(d, 16.0f)), hn::Set(d, 1.0f / 90)));
  e = mul_add(taken, hn::Mul(hn::Mul(hn::Abs(arch), hn::Set(d, 0.5f * colors.color_slope())), ends), e);
  s.error = mul_add(taken, hn::Mul(counted, hn::Set(d, share * colors.color_slope())), e);
  return s;
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
