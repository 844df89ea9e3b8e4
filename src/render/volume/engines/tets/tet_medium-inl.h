// SPDX-License-Identifier: Apache-2.0
// Emission and absorption of lanes in which the value goes straight over a TetMedium; for files that are compiled once for each target and
// have included Highway. No libm: every target gives the same bits.
#if defined(SG_TET_MEDIUM_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_TET_MEDIUM_INL
#undef SG_TET_MEDIUM_INL
#else
#define SG_TET_MEDIUM_INL
#endif
#include "render/shade/exp-inl.h"
#include "render/volume/engines/tets/tet_rays.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, TetPacket::lanes>;
using DI = hn::RebindToSigned<D>;
using F = hn::Vec<D>;
using I = hn::Vec<DI>;
using M = hn::Mask<D>;

HWY_ATTR inline F turn(F ax, F ay, F bx, F by) { return hn::Sub(hn::Mul(ax, by), hn::Mul(ay, bx)); }
HWY_ATTR inline M to_float(hn::Mask<DI> m) { return hn::RebindMask(D(), m); }
HWY_ATTR inline hn::Mask<DI> to_int(M m) { return hn::RebindMask(DI(), m); }

struct Faded {
  F alpha, ratio, hidden;
};

/// Of an optical depth x >= 0: alpha = 1 - exp(-x), alpha / x, and hidden = alpha / 2 - alpha / x + exp(-x).
HWY_ATTR inline Faded fade(F x) {
  const D d;
  // Below 1/2 by their series, which lose nothing for small x; else by exp.
  const auto term = [&](F sum, float c) HWY_ATTR { return hn::Sub(hn::Set(d, c), hn::Mul(sum, x)); };
  F ratio = hn::Set(d, 1.0f / 5040);
  ratio = term(ratio, 1.0f / 720), ratio = term(ratio, 1.0f / 120), ratio = term(ratio, 1.0f / 24), ratio = term(ratio, 1.0f / 6);
  ratio = term(ratio, 0.5f), ratio = term(ratio, 1.0f);
  F hidden = hn::Set(d, 1.0f / 80);
  hidden = term(hidden, 1.0f / 24), hidden = hn::Mul(hn::Mul(term(hidden, 1.0f / 12), x), x);
  Faded r{hn::Mul(ratio, x), ratio, hidden};
  const M large = hn::Gt(x, hn::Set(d, 0.5f));
  if (hn::AllFalse(d, large)) return r;
  const F one = hn::Set(d, 1.0f), pass = shading::HWY_NAMESPACE::exp_minus(x);
  const F alpha = hn::Sub(one, pass), share = hn::Div(alpha, hn::IfThenElse(large, x, one));
  r.alpha = hn::IfThenElse(large, alpha, r.alpha), r.ratio = hn::IfThenElse(large, share, r.ratio);
  r.hidden = hn::IfThenElse(large, hn::Add(hn::Sub(hn::Mul(alpha, hn::Set(d, 0.5f)), share), pass), r.hidden);
  return r;
}

struct Colors {
  F r, g, b, pass;
};

/// The means of tau and of tau times colour over part of one line of the medium, and the colours at its ends.
struct LinePart {
  F tau, r, g, b, front[3], back[3];
  F beside;  ///< over several lines: by how much the mean colour lies beside those at the ends, at most; else 0
  F uneven;  ///< if asked for: how far tau departs from its mean, relative; 1 over several lines
  F moment;  ///< if asked for: the mean of tau times the share of the way
};

/// What is asked for beside the means.
enum class Ask { means, uneven, moment };

HWY_ATTR inline F column(const TetMedium& m, I line, int k) {
  constexpr int stride = int(sizeof(TetMedium::Interval) / 4);
  static_assert(stride == 16);
  return hn::GatherIndex(D(), reinterpret_cast<const float*>(m.intervals.data()) + k, hn::ShiftLeft<4>(line));
}

HWY_ATTR inline F rest(const TetMedium& m, I line, int k) {
  static_assert(sizeof(TetMedium::Rest) == 32);
  return hn::GatherIndex(D(), reinterpret_cast<const float*>(m.rests.data()) + k, hn::ShiftLeft<3>(line));
}

template <Ask ask>
HWY_INLINE HWY_ATTR LinePart part_of_line(const TetMedium& m, I line, F lo, F from, F to) {
  const D d;
  const F x0 = hn::Sub(from, lo), x1 = hn::Sub(to, lo), middle = hn::Mul(hn::Set(d, 0.5f), hn::Add(x0, x1)), width = hn::Sub(to, from);
  const F per_tau = column(m, line, 6), bend = hn::Mul(hn::Mul(hn::Mul(width, width), per_tau), hn::Set(d, 1.0f / 12));
  LinePart p;
  p.beside = hn::Zero(d);
  p.tau = hn::Max(hn::Add(column(m, line, 2), hn::Mul(per_tau, middle)), hn::Zero(d));
  F* const mean[3] = {&p.r, &p.g, &p.b};
  for (int k = 0; k < 3; ++k) {
    const F c = column(m, line, 3 + k), slope = column(m, line, 7 + k);
    p.front[k] = hn::Add(c, hn::Mul(slope, x0)), p.back[k] = hn::Add(c, hn::Mul(slope, x1));
    *mean[k] = hn::Add(hn::Mul(p.tau, hn::Add(c, hn::Mul(slope, middle))), hn::Mul(slope, bend));
  }
  if constexpr (ask != Ask::means) {
    const F rise = hn::Mul(per_tau, width), most = hn::Mul(hn::Set(d, 2.0f), p.tau);
    if constexpr (ask == Ask::moment) p.moment = hn::Add(hn::Mul(hn::Set(d, 0.5f), p.tau), hn::Mul(rise, hn::Set(d, 1.0f / 12)));
    p.uneven = hn::IfThenElseZero(hn::Gt(most, hn::Zero(d)), hn::Div(hn::Min(hn::Abs(rise), most), most));
  }
  return p;
}

/// Slices of the value.
struct Slice {
  const TetMedium& m;
  HWY_ATTR I operator()(F f) const {
    const D d;
    const DI di;
    const F at = hn::Mul(hn::Sub(f, hn::Set(d, m.slice_lo)), hn::Set(d, m.per_slice)), most = hn::Set(d, 1e6f);
    const I s = hn::Add(hn::ConvertTo(di, hn::Min(hn::Max(at, hn::Set(d, -1.0f)), most)), hn::Set(di, 1));
    const I last = hn::Set(di, int32_t(m.first.size()) - 1);
    return hn::Min(hn::IfThenElse(to_int(hn::Lt(at, hn::Zero(d))), hn::Zero(di), s), last);
  }
  /// Is there anything to see between two slices?
  HWY_ATTR M lit(I a, I b) const {
    const DI di;
    const I seen = hn::Sub(hn::GatherIndex(di, m.seen.data() + 1, hn::Max(a, b)), hn::GatherIndex(di, m.seen.data(), hn::Min(a, b)));
    return to_float(hn::Gt(seen, hn::Zero(di)));
  }
};

/// The line that a value belongs to when the field comes from (or goes to) higher values: a knot belongs to the side of the field.
HWY_ATTR inline I line_of(const TetMedium& m, F f, I slice, M above, M on, F& lo, F& hi) {
  const DI di;
  I at = hn::GatherIndex(di, m.first.data(), slice);
  for (;;) {
    hi = column(m, at, 1);
    const M past = hn::And(on, hn::Or(hn::Gt(f, hi), hn::And(above, hn::Eq(f, hi))));
    if (hn::AllFalse(D(), past)) break;
    at = hn::IfThenElse(to_int(past), hn::Add(at, hn::Set(di, 1)), at);
  }
  lo = column(m, at, 0);
  return at;
}

/// Means over the field from f0 to f1.
template <Ask ask>
HWY_ATTR inline LinePart means(const TetMedium& m, F f0, F f1, I slice0, I slice1, M on) {
  const D d;
  const DI di;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const F change = hn::Sub(f1, f0);
  const M down = hn::Lt(change, zero), up = hn::Gt(change, zero);
  F lo0, hi0, lo1, hi1;
  const I line0 = line_of(m, f0, slice0, hn::Not(down), on, lo0, hi0);
  const I line1 = line_of(m, f1, slice1, hn::Not(up), on, lo1, hi1);
  const M same = hn::Or(hn::Or(hn::Not(on), hn::Not(hn::Or(up, down))), to_float(hn::Eq(line0, line1)));
  if (hn::AllTrue(d, same)) return part_of_line<ask>(m, line0, lo0, f0, f1);

  // To the end of the first line, over whole lines, and from the beginning of the last one.
  const F leave = hn::IfThenElse(same, f1, hn::IfThenElse(up, hi0, lo0)), enter = hn::IfThenElse(up, lo1, hi1);
  const LinePart a = part_of_line<ask>(m, line0, lo0, f0, leave);
  const LinePart b = part_of_line<ask>(m, line1, lo1, enter, f1);
  const F per = hn::Div(one, hn::IfThenElse(same, one, change));
  const F share0 = hn::IfThenElse(same, one, hn::Mul(hn::Sub(leave, f0), per));
  const F share1 = hn::IfThenElseZero(hn::Not(same), hn::Mul(hn::Sub(f1, enter), per));
  // Sums stand for the lines before a line: up they are those before line1 less those before line0 + 1, down the other way round.
  const I first = hn::IfThenElse(to_int(up), hn::Add(line0, hn::Set(di, 1)), line0);
  const I last = hn::IfThenElse(to_int(up), line1, hn::Add(line1, hn::Set(di, 1)));
  const M more = hn::AndNot(same, to_float(hn::Ne(first, last)));
  const bool any = !hn::AllFalse(d, more);
  const auto total = [&](F x, F y) HWY_ATTR { return hn::Add(hn::Mul(share0, x), hn::IfThenElseZero(hn::Not(same), hn::Mul(share1, y))); };
  LinePart r;
  r.tau = total(a.tau, b.tau), r.r = total(a.r, b.r), r.g = total(a.g, b.g), r.b = total(a.b, b.b);
  if (any) {
    F* const mean[4] = {&r.tau, &r.r, &r.g, &r.b};
    F whole[4];
    for (int k = 0; k < 4; ++k) whole[k] = hn::Sub(column(m, last, 10 + k), column(m, first, 10 + k));
    if (m.long_sums)
      for (int k = 0; k < 4; ++k) whole[k] = hn::Add(whole[k], hn::Sub(rest(m, last, k), rest(m, first, k)));
    for (int k = 0; k < 4; ++k) *mean[k] = hn::Add(*mean[k], hn::IfThenElseZero(more, hn::Mul(whole[k], per)));
  }
  for (int k = 0; k < 3; ++k) r.front[k] = a.front[k], r.back[k] = hn::IfThenElse(same, a.back[k], b.back[k]);
  // Colours may have risen and fallen again.
  const F per_tau = hn::Div(one, hn::Max(r.tau, hn::Set(d, 1e-37f)));
  const F* const glow[3] = {&r.r, &r.g, &r.b};
  r.beside = zero;
  for (int k = 0; k < 3; ++k) {
    const F c = hn::Mul(*glow[k], per_tau);
    r.beside = hn::Max(r.beside, hn::Max(hn::Abs(hn::Sub(c, r.front[k])), hn::Abs(hn::Sub(c, r.back[k]))));
  }
  r.beside = hn::IfThenElseZero(hn::AndNot(same, hn::Gt(r.tau, zero)), r.beside);
  if constexpr (ask != Ask::means) r.uneven = hn::IfThenElse(same, a.uneven, one);
  if constexpr (ask == Ask::moment) {
    const F behind = hn::Mul(share1, hn::Add(hn::Mul(hn::Sub(one, share1), b.tau), hn::Mul(share1, b.moment)));
    r.moment = hn::Add(hn::Mul(hn::Mul(share0, share0), a.moment), hn::IfThenElseZero(hn::Not(same), behind));
    if (any) {
      F tau = hn::Sub(column(m, last, 10), column(m, first, 10)), of = hn::Sub(column(m, last, 14), column(m, first, 14));
      if (m.long_moments)
        tau = hn::Add(tau, hn::Sub(rest(m, last, 0), rest(m, first, 0))), of = hn::Add(of, hn::Sub(rest(m, last, 4), rest(m, first, 4)));
      const F about = hn::Sub(of, hn::Mul(hn::Sub(f0, hn::Set(d, m.slice_lo)), tau));
      r.moment = hn::Add(r.moment, hn::IfThenElseZero(more, hn::Mul(hn::Mul(about, per), per)));
    }
  }
  return r;
}

/// The finest parts end where lines do: what is as good as opaque hides what lies a millionth of an edge behind. Moves the end of parts in
/// the lanes of `fine`, and the value `to` there. Returns the share of the way that the parts take, which the value tells where places are
/// too near to each other for that.
HWY_NOINLINE HWY_ATTR F end_at_knot(const TetMedium& m, F at, F from, const Slice& slice, M fine, F& end, F& to) {
  const D d;
  const F change = hn::Sub(to, from), zero = hn::Zero(d), hair = hn::Set(d, 0x1p-22f), whole = hn::Sub(end, at);
  F lo, hi;
  line_of(m, from, slice(from), hn::Not(hn::Lt(change, zero)), fine, lo, hi);
  const F knot = hn::IfThenElse(hn::Gt(change, zero), hi, lo), way = hn::Sub(knot, from);
  const F share = hn::Mul(whole, hn::Div(way, hn::IfThenElse(hn::Ne(change, zero), change, hn::Set(d, 1.0f))));
  const F cut = hn::Add(at, share);
  const M ends = hn::And(hn::And(fine, hn::Ne(change, zero)), hn::And(hn::Gt(share, zero), hn::Lt(cut, hn::Sub(end, hair))));
  end = hn::IfThenElse(ends, cut, end), to = hn::IfThenElse(ends, knot, to);
  return hn::IfThenElse(ends, share, whole);
}

/// Parts that are not cut any more.
HWY_ATTR inline M finest(F share) { return hn::Le(share, hn::Set(D(), 1.0f / TetMedium::most_parts)); }

/// A part of several lines that is as short as may be has no order of colours.
HWY_ATTR inline void without_order(M fine, LinePart& p) {
  const M several = hn::And(fine, hn::Ge(p.uneven, hn::Set(D(), 1.0f)));
  for (int k = 0; k < 3; ++k) p.front[k] = hn::IfThenElse(several, p.back[k], p.front[k]);
}

/// Puts one segment behind what is there: C = mean alpha - change hidden, exact for constant tau.
HWY_ATTR inline void behind(const LinePart& p, F length, M on, Colors& sum) {
  const D d;
  const F depth = hn::Mul(p.tau, length);
  const M lit = hn::And(on, hn::Gt(depth, hn::Zero(d)));
  const Faded f = fade(hn::IfThenElseZero(lit, depth));
  const F share = hn::IfThenElseZero(lit, sum.pass), gain = hn::Mul(hn::Mul(share, f.ratio), length), loss = hn::Mul(share, f.hidden);
  F* const to[3] = {&sum.r, &sum.g, &sum.b};
  const F* const mean[3] = {&p.r, &p.g, &p.b};
  for (int k = 0; k < 3; ++k) *to[k] = hn::Add(*to[k], hn::Sub(hn::Mul(gain, *mean[k]), hn::Mul(loss, hn::Sub(p.back[k], p.front[k]))));
  sum.pass = hn::Sub(sum.pass, hn::Mul(share, f.alpha));
}

/// The largest change of a channel from end to end, or to the mean in between.
HWY_ATTR inline F color_change(const LinePart& p) {
  F change = p.beside;
  for (int k = 0; k < 3; ++k) change = hn::Max(change, hn::Abs(hn::Sub(p.back[k], p.front[k])));
  return change;
}

/// The field goes from f0 to f1 over `length` in the lanes of `on`.
HWY_ATTR inline void gather(const TetMedium& m, F f0, F f1, F length, I slice0, I slice1, const Slice& slice, M on, Colors& sum) {
  const D d;
  const LinePart all = means<Ask::means>(m, f0, f1, slice0, slice1, on);
  // Deep segments in parts, so that the order of colours within them counts.
  const F one = hn::Set(d, 1.0f), enough = hn::Set(d, 5.4f / (m.fine * m.fine));
  const F fine = hn::Mul(hn::Set(d, m.fine), hn::Sqrt(hn::Max(color_change(all), hn::Set(d, 1.0f / 256))));
  const M parts = hn::And(on, hn::And(hn::Gt(hn::Mul(hn::Mul(all.tau, length), fine), one), hn::Ne(f0, f1)));
  behind(all, length, hn::AndNot(parts, on), sum);
  F at = hn::Zero(d), step = hn::Set(d, 0.5f), from = f0;
  for (M more = parts; !hn::AllFalse(d, more);) {
    F end = hn::Min(hn::Add(at, step), one);
    F to = hn::IfThenElse(hn::Ge(end, one), f1, hn::Add(f0, hn::Mul(hn::Sub(f1, f0), end)));
    const M fine = hn::And(more, finest(hn::Sub(end, at)));
    const bool any_fine = !hn::AllFalse(d, fine);
    const F share = any_fine ? end_at_knot(m, at, from, slice, fine, end, to) : hn::Sub(end, at);
    LinePart p = means<Ask::uneven>(m, from, to, slice(from), slice(to), more);
    const F depth = hn::Mul(p.tau, hn::Mul(length, share));
    // What the formula does not have: of uneven tau, a 12th of the depth and half at most.
    const M even = hn::Le(hn::Mul(hn::Mul(color_change(p), p.uneven), hn::Min(depth, hn::Set(d, 6.0f))), enough);
    const M good = hn::Or(even, fine);
    if (any_fine) without_order(fine, p);
    behind(p, hn::Mul(length, share), hn::And(more, good), sum);
    at = hn::IfThenElse(good, end, at), from = hn::IfThenElse(good, to, from),
    step = hn::IfThenElse(good, hn::Add(step, step), hn::Mul(hn::Set(d, 0.5f), share));
    more = hn::And(more, hn::And(hn::Lt(at, one), hn::Gt(sum.pass, hn::Set(d, 1e-5f))));
  }
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
