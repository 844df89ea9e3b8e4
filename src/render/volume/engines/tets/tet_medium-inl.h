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
using namespace simd::HWY_NAMESPACE;

using D = hn::CappedTag<float, TetPacket::lanes>;
using DI = hn::RebindToSigned<D>;
using F = Float<D>;
using I = hn::Vec<DI>;
using M = Mask<D>;

HWY_ATTR inline F turn(F ax, F ay, F bx, F by) { return ax * by - ay * bx; }
HWY_ATTR inline M to_float(hn::Mask<DI> m) { return rebind(D(), m); }
HWY_ATTR inline hn::Mask<DI> to_int(M m) { return rebind(DI(), m); }

struct Faded {
  F alpha, ratio, hidden;
};

/// Of an optical depth x >= 0: alpha = 1 - exp(-x), alpha / x, and hidden = alpha / 2 - alpha / x + exp(-x).
HWY_ATTR inline Faded fade(F x) {
  const D d;
  // Below 1/2 by their series, which lose no digits for small x; else by exp.
  const auto term = [&](F sum, float c) HWY_ATTR { return c - sum * x; };
  F ratio = set(d, 1.0f / 5040);
  ratio = term(ratio, 1.0f / 720), ratio = term(ratio, 1.0f / 120), ratio = term(ratio, 1.0f / 24), ratio = term(ratio, 1.0f / 6);
  ratio = term(ratio, 0.5f), ratio = term(ratio, 1.0f);
  F hidden = set(d, 1.0f / 80);
  hidden = term(hidden, 1.0f / 24), hidden = term(hidden, 1.0f / 12) * x * x;
  Faded r{ratio * x, ratio, hidden};
  const M large = x > 0.5f;
  if (none(large)) return r;
  const F one = set(d, 1.0f), pass = shading::HWY_NAMESPACE::exp_minus(x);
  const F alpha = one - pass, share = alpha / select(large, x, one);
  r.alpha = select(large, alpha, r.alpha), r.ratio = select(large, share, r.ratio);
  r.hidden = select(large, alpha * 0.5f - share + pass, r.hidden);
  return r;
}

struct Colors {
  F r, g, b, pass;
};

/// The means of tau and of tau times colour over part of one line of the medium, and the colours at its ends.
struct LinePart {
  F tau, r, g, b, front[3], back[3];
  F beside;  ///< over several lines: largest distance of the mean colour from those at the ends; else 0
  F uneven;  ///< if asked for: how far tau departs from its mean, relative; 1 over several lines
  F moment;  ///< if asked for: the mean of tau times the share of the way
};

/// What to compute besides the means.
enum class Ask { means, uneven, moment };

HWY_ATTR inline F column(const TetMedium& m, I line, int k) {
  constexpr int stride = int(sizeof(TetMedium::Interval) / 4);
  static_assert(stride == 16);
  return hn::GatherIndex(D(), reinterpret_cast<const float*>(m.intervals.data()) + k, shift_left<4>(line));
}

HWY_ATTR inline F rest(const TetMedium& m, I line, int k) {
  static_assert(sizeof(TetMedium::Rest) == 32);
  return hn::GatherIndex(D(), reinterpret_cast<const float*>(m.rests.data()) + k, shift_left<3>(line));
}

template <Ask ask>
HWY_INLINE HWY_ATTR LinePart part_of_line(const TetMedium& m, I line, F lo, F from, F to) {
  const D d;
  const F x0 = from - lo, x1 = to - lo, middle = 0.5f * (x0 + x1), width = to - from;
  const F per_tau = column(m, line, 6), bend = width * width * per_tau * (1.0f / 12);
  LinePart p;
  p.beside = set(d, 0);
  p.tau = max(column(m, line, 2) + per_tau * middle, 0);
  F* const mean[3] = {&p.r, &p.g, &p.b};
  for (int k = 0; k < 3; ++k) {
    const F c = column(m, line, 3 + k), slope = column(m, line, 7 + k);
    p.front[k] = c + slope * x0, p.back[k] = c + slope * x1;
    *mean[k] = p.tau * (c + slope * middle) + slope * bend;
  }
  if constexpr (ask != Ask::means) {
    const F rise = per_tau * width, most = 2.0f * p.tau;
    if constexpr (ask == Ask::moment) p.moment = 0.5f * p.tau + rise * (1.0f / 12);
    p.uneven = only(most > 0, min(abs(rise), most) / most);
  }
  return p;
}

/// Slices of the value.
struct Slice {
  const TetMedium& m;
  HWY_ATTR I operator()(F f) const {
    const D d;
    const DI di;
    const F at = (f - m.slice_lo) * m.per_slice, most = set(d, 1e6f);
    const I s = convert(di, min(max(at, -1.0f), most)) + 1;
    const I last = set(di, int32_t(m.first.size()) - 1);
    return min(select(to_int(at < 0), 0, s), last);
  }
  /// Whether anything is visible between two slices.
  HWY_ATTR M lit(I a, I b) const {
    const DI di;
    const I seen = hn::GatherIndex(di, m.seen.data() + 1, max(a, b)) - hn::GatherIndex(di, m.seen.data(), min(a, b));
    return to_float(seen > 0);
  }
};

/// The line that a value belongs to when the field comes from (or goes to) higher values: a knot belongs to the side that the field comes
/// from or goes to.
HWY_ATTR inline I line_of(const TetMedium& m, F f, I slice, M above, M on, F& lo, F& hi) {
  const DI di;
  I at = hn::GatherIndex(di, m.first.data(), slice);
  for (;;) {
    hi = column(m, at, 1);
    const M past = on & ((f > hi) | (above & (f == hi)));
    if (none(past)) break;
    at = select(to_int(past), at + 1, at);
  }
  lo = column(m, at, 0);
  return at;
}

/// Means over the field from f0 to f1.
template <Ask ask>
HWY_ATTR inline LinePart means(const TetMedium& m, F f0, F f1, I slice0, I slice1, M on) {
  const D d;
  const F zero = set(d, 0), one = set(d, 1.0f);
  const F change = f1 - f0;
  const M down = change<zero, up = change> zero;
  F lo0, hi0, lo1, hi1;
  const I line0 = line_of(m, f0, slice0, !down, on, lo0, hi0);
  const I line1 = line_of(m, f1, slice1, !up, on, lo1, hi1);
  const M same = !on | !(up | down) | to_float(line0 == line1);
  if (all(same)) return part_of_line<ask>(m, line0, lo0, f0, f1);

  // To the end of the first line, over whole lines, and from the start of the last one.
  const F leave = select(same, f1, select(up, hi0, lo0)), enter = select(up, lo1, hi1);
  const LinePart a = part_of_line<ask>(m, line0, lo0, f0, leave);
  const LinePart b = part_of_line<ask>(m, line1, lo1, enter, f1);
  const F per = one / select(same, one, change);
  const F share0 = select(same, one, (leave - f0) * per);
  const F share1 = only(!same, (f1 - enter) * per);
  // Sums cover the lines before a line: up they are those before line1 less those before line0 + 1, down the other way round.
  const I first = select(to_int(up), line0 + 1, line0);
  const I last = select(to_int(up), line1, line1 + 1);
  const M more = to_float(first != last) & !same;
  const bool whole_lines = any(more);
  const auto total = [&](F x, F y) HWY_ATTR { return share0 * x + only(!same, share1 * y); };
  LinePart r;
  r.tau = total(a.tau, b.tau), r.r = total(a.r, b.r), r.g = total(a.g, b.g), r.b = total(a.b, b.b);
  if (whole_lines) {
    F* const mean[4] = {&r.tau, &r.r, &r.g, &r.b};
    F whole[4];
    for (int k = 0; k < 4; ++k) whole[k] = column(m, last, 10 + k) - column(m, first, 10 + k);
    if (m.long_sums)
      for (int k = 0; k < 4; ++k) whole[k] = whole[k] + (rest(m, last, k) - rest(m, first, k));
    for (int k = 0; k < 4; ++k) *mean[k] = *mean[k] + only(more, whole[k] * per);
  }
  for (int k = 0; k < 3; ++k) r.front[k] = a.front[k], r.back[k] = select(same, a.back[k], b.back[k]);
  // Colours may have risen and fallen again.
  const F per_tau = one / max(r.tau, 1e-37f);
  const F* const glow[3] = {&r.r, &r.g, &r.b};
  r.beside = zero;
  for (int k = 0; k < 3; ++k) {
    const F c = *glow[k] * per_tau;
    r.beside = max(r.beside, max(abs(c - r.front[k]), abs(c - r.back[k])));
  }
  r.beside = only((r.tau > zero) & !same, r.beside);
  if constexpr (ask != Ask::means) r.uneven = select(same, a.uneven, one);
  if constexpr (ask == Ask::moment) {
    const F behind = share1 * ((one - share1) * b.tau + share1 * b.moment);
    r.moment = share0 * share0 * a.moment + only(!same, behind);
    if (whole_lines) {
      F tau = column(m, last, 10) - column(m, first, 10), of = column(m, last, 14) - column(m, first, 14);
      if (m.long_moments) tau = tau + (rest(m, last, 0) - rest(m, first, 0)), of = of + (rest(m, last, 4) - rest(m, first, 4));
      const F about = of - (f0 - m.slice_lo) * tau;
      r.moment = r.moment + only(more, about * per * per);
    }
  }
  return r;
}

/// The finest parts end where lines do: what is practically opaque hides what lies a millionth of an edge behind. Moves the end of parts in
/// the lanes of `fine`, and the value `to` there. Returns the share of the segment that the parts take, computed from the values where
/// positions are too close together.
HWY_NOINLINE HWY_ATTR F end_at_knot(const TetMedium& m, F at, F from, const Slice& slice, M fine, F& end, F& to) {
  const D d;
  const F change = to - from, zero = set(d, 0), hair = set(d, 0x1p-22f), whole = end - at;
  F lo, hi;
  line_of(m, from, slice(from), !(change < zero), fine, lo, hi);
  const F knot = select(change > zero, hi, lo), way = knot - from;
  const F share = whole * (way / select(change != zero, change, 1.0f));
  const F cut = at + share;
  const M ends = fine & (change != zero) & ((share > zero) & (cut < end - hair));
  end = select(ends, cut, end), to = select(ends, knot, to);
  return select(ends, share, whole);
}

/// Parts that are not cut further.
HWY_ATTR inline M finest(F share) { return share <= 1.0f / TetMedium::most_parts; }

/// A part of several lines of minimal length has no order of colours.
HWY_ATTR inline void without_order(M fine, LinePart& p) {
  const M several = fine & (p.uneven >= 1.0f);
  for (int k = 0; k < 3; ++k) p.front[k] = select(several, p.back[k], p.front[k]);
}

/// Composites one segment behind what is there: C = mean alpha - change hidden, exact for constant tau.
HWY_ATTR inline void behind(const LinePart& p, F length, M on, Colors& sum) {
  const F depth = p.tau * length;
  const M lit = on & (depth > 0);
  const Faded f = fade(only(lit, depth));
  const F share = only(lit, sum.pass), gain = share * f.ratio * length, loss = share * f.hidden;
  F* const to[3] = {&sum.r, &sum.g, &sum.b};
  const F* const mean[3] = {&p.r, &p.g, &p.b};
  for (int k = 0; k < 3; ++k) *to[k] = *to[k] + (gain * *mean[k] - loss * (p.back[k] - p.front[k]));
  sum.pass = sum.pass - share * f.alpha;
}

/// The largest change of a channel from end to end, or to the mean in between.
HWY_ATTR inline F color_change(const LinePart& p) {
  F change = p.beside;
  for (int k = 0; k < 3; ++k) change = max(change, abs(p.back[k] - p.front[k]));
  return change;
}

/// The field goes from f0 to f1 over `length` in the lanes of `on`.
HWY_ATTR inline void gather(const TetMedium& m, F f0, F f1, F length, I slice0, I slice1, const Slice& slice, M on, Colors& sum) {
  const D d;
  const LinePart all = means<Ask::means>(m, f0, f1, slice0, slice1, on);
  // Deep segments in parts, so that the order of colours within them counts.
  const F one = set(d, 1.0f), enough = set(d, 5.4f / (m.fine * m.fine));
  const F fine = m.fine * sqrt(max(color_change(all), 1.0f / 256));
  const M parts = on & ((all.tau * length * fine > one) & (f0 != f1));
  behind(all, length, on & !parts, sum);
  F at = set(d, 0), step = set(d, 0.5f), from = f0;
  for (M more = parts; any(more);) {
    F end = min(at + step, one);
    F to = select(end >= one, f1, f0 + (f1 - f0) * end);
    const M fine = more & finest(end - at);
    const bool any_fine = any(fine);
    const F share = any_fine ? end_at_knot(m, at, from, slice, fine, end, to) : end - at;
    LinePart p = means<Ask::uneven>(m, from, to, slice(from), slice(to), more);
    const F depth = p.tau * (length * share);
    // What the formula does not have: of uneven tau, a 12th of the depth and half at most.
    const M even = color_change(p) * p.uneven * min(depth, 6.0f) <= enough;
    const M good = even | fine;
    if (any_fine) without_order(fine, p);
    behind(p, length * share, more & good, sum);
    at = select(good, end, at), from = select(good, to, from), step = select(good, step + step, 0.5f * share);
    more = more & ((at < one) & (sum.pass > 1e-5f));
  }
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
