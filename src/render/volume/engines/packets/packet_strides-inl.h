// SPDX-License-Identifier: Apache-2.0
// Strides along packets of rays: stretches longer than cells, on which the value is as good as straight. What a stride gets wrong is
// bounded by how far the field bends there (Bends) and how steep the medium is over the values met (MediumSums).
#if defined(SG_PACKET_STRIDES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_STRIDES_INL_H
#undef SG_PACKET_STRIDES_INL_H
#else
#define SG_PACKET_STRIDES_INL_H
#endif

#include "render/volume/engines/packets/packets-inl.h"
#include "render/volume/medium/medium_sums.h"
#include "render/volume/sources/lattice/bends.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// MediumSums, ready for gathers.
template <class D>
struct SumLanes {
  using F = Float<D>;
  using I = Int<D>;
  const MediumSums* sums;
  bool loads;  ///< of gathers.h

  /// The medium at a value: sigma_t, and the integral of sigma_t up to it in two parts.
  struct Place {
    F value, sigma_t, slope, beyond, kinks;
    I node, sum;
  };
  HWY_INLINE Place at(F value) const {
    const D d;
    const IntTag<D> di;
    const F zero = set(d, 0), top = set(d, float(MediumSums::nodes - 1)), lo = set(d, sums->lo());
    F at = (value - lo) * sums->per_width();
    at = min(max(at, zero), top);  // no number: the first
    Place p;
    p.value = value, p.node = to_int(d, at);
    const auto* table = reinterpret_cast<const float*>(sums->table());
    const I entry = shift_left<2>(p.node);
    const auto [sum_sigma_t, slope] = gather_quad(d, table, entry, loads);
    p.sum = bit_cast(di, sum_sigma_t.a);
    const F x = neg_mul_add(convert(d, p.node), sums->width(), value - lo);
    p.slope = slope.a, p.kinks = slope.b;
    const F rise = x * slope.a;
    p.beyond = x * mul_add(0.5f, rise, sum_sigma_t.b);
    p.sigma_t = max(zero, sum_sigma_t.b + rise);
    return p;
  }
  /// The mean of sigma_t over the values between two places; `even` is that of a straight line.
  HWY_INLINE F mean(const Place& a, const Place& b, F even) const {
    const D d;
    const F change = b.value - a.value;
    const F whole = convert(d, b.sum - a.sum) * sums->per_sum();
    const F all = whole + (b.beyond - a.beyond);
    const auto near = abs(change) < 2 * sums->width();
    return select(near, even, max(0, all / select(near, 1.0f, change)));
  }
  /// The largest |slope| of sigma_t between two places, so many nodes to both sides.
  HWY_INLINE F steepest(const Place& a, const Place& b, I pad) const {
    const D d;
    const IntTag<D> di;
    const hn::RebindToUnsigned<IntTag<D>> du;
    const I lower = max(0, min(a.node, b.node) - pad);
    const I upper = min(MediumSums::nodes - 1, max(a.node, b.node) + pad);
    // 2^level > upper - lower.
    const I exponent = shift_right<23>(bit_cast(di, convert(d, upper - lower)));
    const auto level = bit_cast(du, max(0, exponent - 126));
    const auto all = set(du, uint32_t(2 * MediumSums::nodes));
    const auto first = all - hn::Shr(all, level);
    const auto entry = bit_cast(di, first + hn::Shr(bit_cast(du, lower), level));
    return bit_cast(d, gather_words(d, sums->steepest(), shift_left<2>(entry), loads));
  }
  /// As many as the values change by, and one.
  HWY_INLINE I nodes_over(F change) const {
    const D d;
    return to_int(d, min(change * sums->per_width(), float(MediumSums::nodes))) + 1;
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
  Float<D> depth;             ///< optical
  Float<D> error;             ///< of the optical depth, and of the share of the light that gets a wrong colour
  Float<D> ahead;             ///< what more (or less) there would be to get wrong if it went on like the second
  Float<D> value;             ///< the mean by emission,
  Float<D> middle, variance;  ///< and where it lies
  Float<D> change;            ///< largest less smallest value
  Float<D> uneven;            ///< of a change of colour or light, the share that is hidden otherwise, or lies elsewhere
};

/// From p0 by p1 to p2, each stride `world` long; the slope of the value changes by at most `bend` per cell length, of which a stride has
/// `cells`.
template <bool shaded, class D>
HWY_INLINE Strides<D> strides(const SumLanes<D>& medium, const Medium& colors, float tolerance, const typename SumLanes<D>::Place& p0,
                              const typename SumLanes<D>::Place& p1, const typename SumLanes<D>::Place& p2, Float<D> world, Float<D> cells,
                              Float<D> bend) {
  using F = Float<D>;
  const D d;
  const F zero = set(d, 0), one = set(d, 1.0f), half = set(d, 0.5f), third = set(d, 1.0f / 3);
  const F rise_a = p1.value - p0.value, rise_b = p2.value - p1.value;
  const F arch = rise_b - rise_a;  // the second difference
  const F both_a = p0.sigma_t + p1.sigma_t, both_b = p1.sigma_t + p2.sigma_t;
  const F even_a = half * both_a, even_b = half * both_b;
  const F mean_a = medium.mean(p0, p1, even_a), mean_b = medium.mean(p1, p2, even_b);
  const F lo = min(p0.value, min(p1.value, p2.value)), hi = max(p0.value, max(p1.value, p2.value)), change = hi - lo;
  constexpr float share = shaded ? share_off_lit : share_off;
  // A fourth of it at most, an eighth in the mean. Short strides meet one face of cells at most, where all of a cell's bend may be.
  const F off = bend * (cells * max(cells, half));
  const auto pad = medium.nodes_over(0.25f * off);
  const F steep_a = medium.steepest(p0, p1, pad), steep_b = medium.steepest(p1, p2, pad);
  // A parabola lies `arch` / 12 below its chord in the mean.
  const F sagging = 1.0f / 24 * arch;
  const F depth_a = max(zero, neg_mul_add(sagging, p0.slope + p1.slope, mean_a));
  const F depth_b = max(zero, neg_mul_add(sagging, p1.slope + p2.slope, mean_b));
  const F sum = depth_a + depth_b, twice = world + world;
  Strides<D> s;
  s.change = change;
  s.depth = world * sum;

  // Where a stride's sigma_t goes straight its middle lies between a third and two thirds of it.
  const F least = set(d, 1e-30f), twice_least = set(d, 2e-30f);
  const auto share_of = [&](F part, F all) HWY_ATTR { return (part + least) / (all + twice_least); };
  const F w_a = mul_add(third, share_of(p1.sigma_t, both_a), third), w_b = mul_add(third, share_of(p2.sigma_t, both_b), third);
  const F share_b = share_of(depth_b, sum), share_a = one - share_b;
  const F from_a = w_a - one;
  s.middle = mul_add(share_b, w_b, share_a * from_a);
  s.value = neg_mul_add(1.0f / 12, arch, p1.value + mul_add(share_b * w_b, rise_b, share_a * from_a * rise_a));
  const auto spread = [&](F w) HWY_ATTR { return neg_mul_add(w, w, w - 1.0f / 6); };
  const F apart = w_b - from_a;
  s.variance = mul_add(share_a * share_b, apart * apart, mul_add(share_b, spread(w_b), share_a * spread(w_a)));

  // Colours bend on a width; where sigma_t is no straight line between the ends its middle lies elsewhere, by two thirds of the stride at
  // most; in a deep stride the front shows more of its own colour.
  const F taken = min(one, s.depth);
  const F recolored = min(one, change * colors.color_slope());
  const F widths = change * (1 / colors.color_width());
  // A constant sigma_t would hide as much of the back as this one by two straight pieces does, but for 1 / 240 of the square of what the
  // depth tilts by, and 1 / 192 of the depth times what it turns by in the middle; and the third order. Twice that, as sigma_t may do more.
  const F tilt = twice * abs(p2.sigma_t - p0.sigma_t), turn = twice * abs(p0.sigma_t + p2.sigma_t - (p1.sigma_t + p1.sigma_t));
  const F tilted = mul_add(s.depth * s.depth, 1.0f / 360, tilt * (1.0f / 120));
  const F deep = mul_add(tilt, tilted, s.depth * (turn * (1.0f / 96)));
  const F uneven = third * world * (abs(mean_a - even_a) + abs(mean_b - even_b));
  const F counted = max(off * least_off, min(off, abs(arch) * times_met));
  const F per_steep = world * (counted * share);
  F e = per_steep * (steep_a + steep_b);
  s.ahead = per_steep * (steep_b - steep_a);
  e = mul_add(taken * (0.25f * tolerance), widths * widths, e);
  s.uneven = min(one, deep) + uneven;
  e = mul_add(recolored, s.uneven, e);
  // Where colours kink they leave the straight line to both ends by up to a fourth of what their slope changes by, an eighth in the mean;
  // a deep pair shows its front alone.
  if (medium.sums->kinked()) {
    const F kinks = max(p0.kinks, max(p1.kinks, p2.kinks)) - min(p0.kinks, min(p1.kinks, p2.kinks));
    const F shown = mul_add(min(s.depth, 8.0f), 1.0f / 64, 0.125f);
    e = mul_add(taken * shown, min(one, kinks * change), e);
  }
  // A deep pair shows the ends of a parabola of colours more than its middle: for weights exp(-depth x / 2) the mean of x^2 is
  // 1/3 + depth^2 / 90, and below 1/3 + 4^2 / 90 + 3 (depth - 4) / 100 from 4 on, 1 at most.
  const F deeper = min(max(s.depth - 4.0f, zero), 49.0f / 3);
  const F ends = mul_add(deeper, 0.03f, min(s.depth * s.depth, 16.0f) * (1.0f / 90));
  e = mul_add(taken, abs(arch) * (0.5f * colors.color_slope()) * ends, e);
  s.error = mul_add(taken, counted * (share * colors.color_slope()), e);
  return s;
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
