// SPDX-License-Identifier: Apache-2.0
// Strides along packets of rays: stretches longer than cells, on which the value is as good as straight. What a stride gets wrong is
// bounded by how far the field bends there (Bends) and how steep the medium is over the values met (MediumSums).
#if defined(SG_PACKET_STRIDES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_STRIDES_INL_H
#undef SG_PACKET_STRIDES_INL_H
#else
#define SG_PACKET_STRIDES_INL_H
#endif

#include "render/volume/lattice/bends.h"
#include "render/volume/lattice/packets_inl.h"
#include "render/volume/optics/medium_sums.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// MediumSums, ready for gathers.
template <class D>
struct SumLanes {
  using F = hn::Vec<D>;
  using I = Int<D>;
  const MediumSums* sums;

  /// The medium at a value: tau, and the integral of tau up to it in two parts.
  struct Place {
    F value, tau, slope, beyond;
    I node, sum;
  };
  HWY_INLINE Place at(F value) const {
    const D d;
    const IntTag<D> di;
    const F zero = hn::Zero(d), top = hn::Set(d, float(MediumSums::nodes - 1)), lo = hn::Set(d, sums->lo());
    F at = hn::Mul(hn::Sub(value, lo), hn::Set(d, sums->per_width()));
    at = hn::IfThenElseZero(hn::Ge(at, zero), hn::Min(at, top));
    Place p;
    p.value = value, p.node = to_int(d, at);
    const auto* table = reinterpret_cast<const float*>(sums->table());
    const I entry = hn::ShiftLeft<2>(p.node);
    const Pair<D> sum_tau = gather_pair(d, table, entry), slope = gather_pair(d, table + 2, entry);
    p.sum = hn::BitCast(di, sum_tau.a);
    const F x = hn::Sub(hn::Sub(value, lo), hn::Mul(hn::ConvertTo(d, p.node), hn::Set(d, sums->width())));
    p.slope = slope.a;
    const F rise = hn::Mul(x, slope.a);
    p.beyond = hn::Mul(x, hn::Add(sum_tau.b, hn::Mul(hn::Set(d, 0.5f), rise)));
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
  /// The largest |slope| of tau between two places, `air` to both sides.
  HWY_INLINE F steepest(const Place& a, const Place& b, F air) const {
    const D d;
    const IntTag<D> di;
    const hn::RebindToUnsigned<IntTag<D>> du;
    const I pad =
        hn::Add(to_int(d, hn::Min(hn::Mul(air, hn::Set(d, sums->per_width())), hn::Set(d, float(MediumSums::nodes)))), hn::Set(di, 1));
    const I lower = hn::Max(hn::Zero(di), hn::Sub(hn::Min(a.node, b.node), pad));
    const I upper = hn::Min(hn::Set(di, MediumSums::nodes - 1), hn::Add(hn::Max(a.node, b.node), pad));
    // 2^level > upper - lower.
    const I exponent = hn::ShiftRight<23>(hn::BitCast(di, hn::ConvertTo(d, hn::Sub(upper, lower))));
    const auto level = hn::BitCast(du, hn::Max(hn::Zero(di), hn::Sub(exponent, hn::Set(di, 126))));
    const auto all = hn::Set(du, uint32_t(2 * MediumSums::nodes));
    const auto first = hn::Sub(all, hn::Shr(all, level));
    return hn::GatherIndex(d, sums->steepest(), hn::BitCast(di, hn::Add(first, hn::Shr(hn::BitCast(du, lower), level))));
  }
};

constexpr float share_off = 0.025f;

/// What a stride would bring, and get wrong.
template <class D>
struct Stride {
  hn::Vec<D> depth;   ///< optical
  hn::Vec<D> error;   ///< of the optical depth, and of the share of the light that gets a wrong colour
  hn::Vec<D> middle;  ///< mean value by emission,
  hn::Vec<D> weight;  ///< which lies so far on
};

/// From a to b, `world` long; the slope of the value changes by at most `bend` per cell length, of which the stride has `cells`.
template <class D>
HWY_INLINE Stride<D> stride(const SumLanes<D>& medium, const Medium& colors, float tolerance, const typename SumLanes<D>::Place& a,
                            const typename SumLanes<D>::Place& b, hn::Vec<D> world, hn::Vec<D> cells, hn::Vec<D> bend, hn::Vec<D> arch) {
  using F = hn::Vec<D>;
  const D d;
  const F one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const F both = hn::Add(a.tau, b.tau), even = hn::Mul(half, both), mean = medium.mean(a, b, even);
  const F off = hn::Mul(bend, hn::Mul(cells, cells));  // a fourth of it at most, an eighth in the mean
  const F steepest = medium.steepest(a, b, hn::Mul(hn::Set(d, 0.25f), off));
  const F rise = hn::Sub(b.value, a.value), change = hn::Abs(rise);
  Stride<D> s;
  // A parabola lies `arch` / 12 below its chord in the mean.
  const F sagging = hn::Mul(hn::Mul(hn::Set(d, 1.0f / 24), arch), hn::Add(a.slope, b.slope));
  s.depth = hn::Mul(world, hn::Max(hn::Zero(d), hn::Sub(mean, sagging)));
  // Colours bend on a width; where tau is no straight line between the ends its middle lies elsewhere; in a deep stride the front shows
  // more of its own colour than a constant tau would have it (optics/integrate.cpp, Pieces::whole).
  const F recolored = hn::Min(one, hn::Mul(change, hn::Set(d, colors.color_slope())));
  const F widths = hn::Mul(change, hn::Set(d, 1 / colors.color_width()));
  const F deep =
      hn::Mul(hn::Mul(hn::Mul(world, world), hn::Mul(hn::Max(hn::Max(a.tau, b.tau), mean), steepest)), hn::Mul(change, hn::Set(d, 0.05f)));
  F e = hn::Mul(hn::Mul(world, steepest), hn::Mul(off, hn::Set(d, share_off)));
  e = hn::Add(e, hn::Mul(hn::Mul(hn::Min(one, s.depth), hn::Set(d, 0.25f * tolerance)), hn::Mul(widths, widths)));
  e = hn::Add(e, hn::Mul(recolored, hn::Add(hn::Min(one, deep), hn::Mul(hn::Mul(half, world), hn::Abs(hn::Sub(mean, even))))));
  e = hn::Add(e, hn::Mul(hn::Min(one, s.depth), hn::Mul(off, hn::Set(d, share_off * colors.color_slope()))));
  s.error = e;
  const auto thin = hn::Lt(both, hn::Set(d, 1e-30f));
  const F per = hn::Div(hn::Set(d, 1.0f / 3), hn::IfThenElse(thin, one, both));
  s.weight = hn::IfThenElse(thin, half, hn::Mul(hn::Add(both, b.tau), per));
  s.middle = hn::Sub(hn::Add(a.value, hn::Mul(rise, s.weight)), hn::Mul(hn::Set(d, 1.0f / 12), arch));
  return s;
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
