// SPDX-License-Identifier: Apache-2.0
// Cells that the lanes of a packet cross, integrated within a tolerance: in a cell the field along the ray is a cubic, cut at the knots of
// the medium.
#if defined(SG_PACKET_CELLS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_CELLS_INL_H
#undef SG_PACKET_CELLS_INL_H
#else
#define SG_PACKET_CELLS_INL_H
#endif

#include "render/volume/engines/packets/packet_cubic_inl.h"
#include "render/volume/engines/packets/packet_light_inl.h"
#include "render/volume/engines/packets/packet_medium_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// What is gathered so far, and where half of the light was gone.
template <class D>
struct Gathering {
  hn::Vec<D> r, g, b, pass, half_at;
  HWY_INLINE Gathering() {
    const D d;
    r = g = b = hn::Zero(d), pass = hn::Set(d, 1.0f), half_at = hn::Set(d, -1.0f);
  }
};

/// The rays of a packet in their lattice.
template <class D, class T, class Axes>
struct RayLanes {
  using F = hn::Vec<D>;
  using I = Int<D>;
  using M = hn::Mask<D>;

  const PacketPlan& plan;
  const Source<D, T> source;
  const Axes axes;
  F start[3], along[3];  ///< in q: where the rays enter, and one world length
  Gathering<D> sum;

  HWY_INLINE RayLanes(const PacketPlan& p, const RayPacket& rays)
      : plan(p), source(p.volume.voxels, p.volume.within_samples()), axes(p, source) {
    const D d;
    // Rays that miss stay where there are samples.
    const M meets = hn::Gt(hn::Load(d, rays.length), hn::Zero(d));
    const auto of_meeting = [&](const float* from) HWY_ATTR { return hn::IfThenElseZero(meets, hn::Load(d, from)); };
    for (int a = 0; a < 3; ++a) start[a] = of_meeting(rays.entry[a]), along[a] = of_meeting(rays.along[a]);
  }
  /// The way from t to `leave` through a cell each, in shares of its edges.
  HWY_INLINE void way_through(const I cell[3], F t, F leave, F from[3], F way[3]) const {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    for (int a = 0; a < 3; ++a) {
      const auto shares = axes.shares(a, cell[a], start[a]);
      from[a] = hn::Max(zero, hn::Min(shares.at(along[a], t), one));
      way[a] = hn::Sub(hn::Max(zero, hn::Min(shares.at(along[a], leave), one)), from[a]);
    }
  }
};

template <class D, class T, bool shaded, class Axes>
class PacketCells : public RayLanes<D, T, Axes> {
  using Rays = RayLanes<D, T, Axes>;
  using typename Rays::F, typename Rays::I, typename Rays::M;

 public:
  using Rays::plan, Rays::source, Rays::axes, Rays::sum;
  const MediumLanes<D> medium;
  const Lighting<D> lighting;

  HWY_INLINE PacketCells(const PacketPlan& p, const RayPacket& rays)
      : Rays(p, rays), medium(*p.medium), lighting(p, rays), light(lighting, axes) {
    at_ = hn::Zero(IntTag<D>());
    line_ = medium.line(at_);
  }

  /// What a change of the value by `range` and of its light by `lightening` may have of itself hidden by its front, in a fifth of the
  /// tolerance. `covary`: by how much of that light the colours are lit as they change, 0 where they have one light each.
  HWY_INLINE void may_hide(F range, F lightening, F covary) {
    const D d;
    const F per = hn::Set(d, 1 / (0.2f * float(plan.budget.tolerance))),
            recolored = hn::Mul(range, hn::Set(d, medium.medium.color_slope()));
    F change = hn::Add(recolored, lightening);
    if (medium.medium.pieced()) change = hn::Max(change, hn::Set(d, 1.0f));
    most_hidden_ = hn::Mul(change, per), most_covary_ = hn::Mul(hn::Mul(recolored, covary), hn::Mul(per, hn::Set(d, 1.0f / 3)));
  }

  /// One cell per lane: its cubic, and what the medium makes of it.
  HWY_INLINE void cross(const I inside[3], F t, F leave, M look) {
    const D d;
    F from[3], way[3];
    this->way_through(inside, t, leave, from, way);
    Pair<D> rows[4];
    source.corners(source.offset(inside[0], inside[1], inside[2]), rows);
    const auto &p00 = rows[0], &p01 = rows[1], &p10 = rows[2], &p11 = rows[3];
    // No place in the cell lies outside the range of its corners.
    const F least = hn::Min(hn::Min(hn::Min(p00.a, p00.b), hn::Min(p01.a, p01.b)), hn::Min(hn::Min(p10.a, p10.b), hn::Min(p11.a, p11.b)));
    const F largest = hn::Max(hn::Max(hn::Max(p00.a, p00.b), hn::Max(p01.a, p01.b)), hn::Max(hn::Max(p10.a, p10.b), hn::Max(p11.a, p11.b)));
    const M clear_line = line_.dark();
    if (hn::AllFalse(d, hn::AndNot(hn::And(clear_line, hn::And(hn::Ge(least, line_.lo), hn::Le(largest, line_.hi))), look))) return;
    const Cubic<D> f = along_way(rows, from, way);
    F lo, hi;
    f.hull(lo, hi);
    look = hn::And(look, hn::Eq(f.last, f.last));  // no hole
    const M strange = hn::AndNot(hn::And(hn::Ge(f.a, line_.lo), hn::Le(f.a, line_.hi)), look);
    // Only these: on a knot either line would do, and which it is must not depend on the other lanes.
    if (!hn::AllFalse(d, strange))
      at_ = hn::IfThenElse(hn::RebindMask(IntTag<D>(), strange), medium.line_of(f.a), at_), line_ = medium.line(at_);
    const M same = hn::And(hn::Ge(lo, line_.lo), hn::Le(hi, line_.hi));
    const M dark = hn::And(same, line_.dark());
    look = hn::AndNot(dark, look);
    if (hn::AllFalse(d, look)) return;
    integrate(f, lo, hi, same, inside, from, way, t, hn::Sub(leave, t), look);
  }

  HWY_INLINE void integrate(const Cubic<D>& f, F lo, F hi, M same, [[maybe_unused]] const I inside[3], const F from[3], const F way[3], F t,
                            F length, M look) {
    const D d;
    const IntTag<D> di;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
    const Medium& m = medium.medium;
    const typename MediumLanes<D>::Line& line = line_;
    const float tolerance = float(plan.budget.tolerance);
    // Of the cubic: a + b/2 + c/3 + e/4.
    const F mean = hn::Add(mul_add(half, f.b, f.a), mul_add(hn::Set(d, 0.25f), f.e, hn::Mul(hn::Set(d, 1.0f / 3), f.c)));
    F tau_mean = line.tau(mean), most = hn::Max(hn::Max(line.tau(lo), line.tau(hi)), tau_mean);
    F slope = hn::Max(line.slope_at(lo), line.slope_at(hi));
    M abrupt = hn::MaskFromVec(zero);  // lanes in which the medium jumps between the values
    if (!hn::AllFalse(d, hn::AndNot(same, look))) {
      const I first = medium.line_of(lo), last = medium.line_of(hi);
      most = hn::IfThenElse(same, most, medium.most(medium.columns.most_tau, first, last));
      slope = hn::IfThenElse(same, slope, medium.most(medium.columns.most_slope, first, last));
      tau_mean = hn::IfThenElse(same, tau_mean, medium.line(medium.line_of(mean)).tau(mean));
      look = hn::And(look, hn::Gt(most, zero));
      if (hn::AllFalse(d, look)) return;
      if (m.any_abrupt()) abrupt = hn::AndNot(same, medium.abrupt(first, last));
    }
    // The errors of rays/integrate.cpp, Pieces::whole.
    const F pass = sum.pass, depth = hn::Mul(length, most), taken = hn::Min(one, depth), range = hn::Sub(hi, lo);
    const F color_slope = hn::Set(d, m.color_slope());
    const F widths = hn::Mul(range, hn::Set(d, 1 / m.color_width())), change = hn::Min(one, hn::Mul(range, color_slope));
    const F bend = hn::Max(hn::Abs(f.c), hn::Abs(mul_add(hn::Set(d, 3.0f), f.e, f.c)));
    const F recolored = hn::Mul(taken, hn::Min(hn::Set(d, 1e6f), hn::Mul(bend, color_slope))), tilt = hn::Mul(length, slope);
    const F deep = hn::Mul(hn::Mul(depth, tilt), hn::Mul(range, hn::Set(d, 0.05f)));
    const F deeper = hn::Min(hn::Set(d, 1.0f / 6), hn::Mul(hn::Mul(depth, depth), hn::Set(d, 1.0f / 360)));
    const F front = mul_add(hn::Min(depth, hn::Set(d, 8.0f)), hn::Set(d, 0.0625f * tolerance), hn::Set(d, 0.25f * tolerance));
    F error = hn::Mul(hn::Mul(taken, front), hn::Mul(widths, widths));
    error = mul_add(change, hn::Min(one, deep), error);
    error = hn::Mul(mul_add(recolored, deeper, error), pass);
    const F fourth = mul_add(hn::Abs(f.e), hn::Add(range, range), hn::Mul(bend, bend));
    const F leaning = hn::Min(hn::Mul(taken, hn::Set(d, 120.0f)), hn::Mul(length, medium.leaning(slope, range, bend, hn::Abs(f.e))));
    const F uneven =
        hn::Mul(hn::Mul(pass, hn::Set(d, 1.0f / 120)), hn::Add(hn::Min(one, hn::Mul(fourth, hn::Mul(tilt, color_slope))), leaning));
    const F share = hn::Mul(pass, hn::Min(one, hn::Mul(length, tau_mean)));
    const F allowed =
        hn::Mul(hn::Set(d, tolerance), mul_add(share, hn::Set(d, 0.4f), hn::Mul(length, hn::Set(d, float(0.3 / plan.budget.length)))));
    F close = zero;  // so near to a knot a value counts as that
    M turning = abrupt;
    bool any_turn = false;
    if (!hn::AllFalse(d, hn::AndNot(same, look))) {
      const F spoilt = hn::Mul(pass, mul_add(taken, color_slope, tilt));
      close = hn::IfThenElseZero(hn::Not(abrupt), hn::Div(hn::Mul(allowed, hn::Set(d, 0.05f)), hn::Max(spoilt, hn::Set(d, 1e-30f))));
      const F beyond = hn::Max(hn::Sub(hi, hn::Max(f.a, f.last)), hn::Sub(hn::Min(f.a, f.last), lo));
      turning = hn::Or(abrupt, hn::AndNot(same, hn::Gt(hn::Mul(beyond, spoilt), hn::Mul(allowed, hn::Set(d, 0.1f)))));
      any_turn = !hn::AllFalse(d, hn::And(look, turning));
    }
    constexpr int most_kinks = shaded ? CellLight<D, T, Axes>::most_jumps : 0;
    F kinks[most_kinks + 2];  // where the light jumps and where the value turns, in any order
    int kink_count = 0;
    if constexpr (shaded) {
      const auto lit = light.error(source, inside, from, way);
      const F weight = hn::Mul(pass, taken);
      error = hn::Max(error, hn::Mul(weight, lit.bend));
      // A piece has one light for all of its colours: a twelfth of how much both change together. In a deep piece the front shows more of
      // its own light, too.
      error = mul_add(hn::Mul(weight, lit.change), hn::Mul(change, hn::Set(d, 1.0f / 12)), error);
      error = mul_add(hn::Mul(pass, lit.change), hn::Min(one, deep), error);
      const M jumping = hn::And(look, hn::Gt(hn::Mul(weight, lit.jump), allowed));
      if (!hn::AllFalse(d, jumping)) kink_count = light.jumps(lit, jumping, kinks);
    }
    if (any_turn) {
      F turn[2];
      f.turns(turn[0], turn[1]);
      for (const F& t : turn) kinks[kink_count++] = hn::IfThenElse(turning, t, hn::Set(d, 2.0f));
    }
    F count = one, per_count = one;
    if (!hn::AllFalse(d, hn::And(look, hn::Gt(hn::Max(error, uneven), allowed)))) {
      const F least = hn::Max(allowed, hn::Set(d, 1e-30f));
      const F parts = hn::Max(hn::Sqrt(hn::Div(error, least)), hn::Sqrt(hn::Sqrt(hn::Div(uneven, least))));
      count = hn::Max(one, hn::Min(hn::Ceil(parts), hn::Set(d, 1024.0f)));
      per_count = hn::Div(one, count);
    }
    const F stop = hn::Set(d, plan.budget.stop_below);
    may_hide(range, shaded ? one : zero, zero);

    // Pieces, cut where the value meets the knots.
    F k = zero, v = f.a, s = zero, end, target;
    M at_kink;
    const auto aim = [&] HWY_ATTR {
      const F after = hn::Add(k, one);
      const M final_piece = hn::Ge(after, count);
      end = hn::IfThenElse(final_piece, one, hn::Mul(after, per_count));
      at_kink = hn::MaskFromVec(zero);
      for (int i = 0; i < kink_count; ++i) {
        const M nearer = hn::And(hn::Gt(kinks[i], s), hn::Lt(kinks[i], end));
        at_kink = hn::Or(at_kink, nearer), end = hn::IfThenElse(nearer, kinks[i], end);
      }
      target = hn::IfThenElse(hn::AndNot(at_kink, final_piece), f.last, f.at(end));
    };
    aim();
    typename MediumLanes<D>::Line& l = line_;
    for (;;) {
      const M up = hn::Ge(target, v);
      const M ends = hn::Or(hn::And(up, hn::Le(target, l.hi)), hn::AndNot(up, hn::Ge(target, l.lo)));
      F to = end, next = target;
      const M cut = hn::AndNot(ends, look);
      if (!hn::AllFalse(d, cut)) {
        const F knot = hn::IfThenElse(up, l.hi, l.lo);
        const F rise = hn::Sub(target, v);
        const F run = hn::Div(hn::Sub(end, s), hn::IfThenElse(hn::Eq(rise, zero), one, rise));
        F meet = mul_add(hn::Sub(knot, v), run, s);
        F off = zero;
        for (int i = 0; i < 2; ++i) {
          off = hn::Sub(f.at(meet), knot);
          meet = hn::Max(s, hn::Min(neg_mul_add(off, run, meet), end));
        }
        const M astray = hn::And(cut, hn::Gt(hn::Abs(off), close));
        if (!hn::AllFalse(d, astray)) meet = hn::IfThenElse(astray, enclosed(f, s, end, v, target, knot, close, astray), meet);
        to = hn::IfThenElse(cut, meet, to), next = hn::IfThenElse(cut, knot, next);
      }
      const F middle = f.at(hn::Mul(half, hn::Add(s, to))), part = hn::Mul(length, hn::Sub(to, s));
      const F t0 = l.tau(v), tm = hn::Mul(hn::Set(d, 4.0f), l.tau(middle)), t1 = l.tau(next), all = hn::Add(hn::Add(t0, tm), t1);
      const F per_all = hn::Div(one, hn::Max(all, hn::Set(d, 1e-37f)));
      const F by_emission = hn::Mul(mul_add(t1, next, mul_add(tm, middle, hn::Mul(t0, v))), per_all);
      const F weight = hn::Mul(mul_add(half, tm, t1), per_all);
      const F taus[3] = {t0, hn::Mul(tm, hn::Set(d, 0.25f)), t1};
      segment(look, mul_add(length, s, t), part, hn::Mul(part, hn::Mul(all, hn::Set(d, 1.0f / 6))), taus, v, next, by_emission, weight,
              &at_, [&](F at, F share, const Spread&, F& red, F& green, F& blue) HWY_ATTR {
                if constexpr (shaded) {
                  const auto on = light.at(mul_add(hn::Sub(to, s), at, s));
                  const F flash = hn::Mul(on.specular, share);
                  for (F* c : {&red, &green, &blue}) *c = mul_add(*c, on.diffuse, flash);
                }
              });
      // On to the next line, or to the next piece.
      k = hn::IfThenElse(hn::AndNot(at_kink, ends), hn::Add(k, one), k);
      look = hn::And(look, hn::And(hn::Lt(k, count), hn::Ge(sum.pass, stop)));
      if (hn::AllFalse(d, look)) return;
      v = next, s = to;
      if (!hn::AllFalse(d, cut)) {
        at_ = hn::IfThenElse(hn::RebindMask(di, cut), hn::Add(at_, hn::IfThenElse(hn::RebindMask(di, up), hn::Set(di, 1), hn::Set(di, -1))),
                             at_);
        l = medium.line(at_);
      }
      aim();
    }
  }

  /// Where a cubic that goes one way from s to end, and from a to b, has a value, to `close`, for the lanes that ask: as Pieces::meets of
  /// rays/integrate.cpp.
  static HWY_NOINLINE F enclosed(const Cubic<D>& f, F s, F end, F a, F b, F value, F close, M asking) {
    const D d;
    const F zero = hn::Zero(d), half = hn::Set(d, 0.5f);
    F meet = s, side = zero, at0 = hn::Sub(a, value), at1 = hn::Sub(b, value);
    M going = hn::AndNot(hn::IsNaN(hn::Add(at0, at1)), asking);
    for (int i = 0; i < 40 && !hn::AllFalse(d, going); ++i) {
      const F apart = hn::Sub(at0, at1);
      const F next = hn::Div(hn::Sub(hn::Mul(at0, end), hn::Mul(at1, s)), hn::IfThenElse(hn::Eq(apart, zero), hn::Set(d, 1.0f), apart));
      meet = hn::IfThenElse(going, hn::Max(s, hn::Min(next, end)), meet);
      const F here = hn::Sub(f.at(meet), value);
      const M inside = hn::And(hn::Gt(meet, s), hn::Lt(meet, end)), wide = hn::Ge(hn::Sub(end, s), hn::Set(d, 1e-6f));
      going = hn::And(going, hn::And(hn::Gt(hn::Abs(here), close), hn::And(inside, wide)));
      const M later = hn::AndNot(hn::Xor(hn::Gt(here, zero), hn::Gt(at1, zero)), going), earlier = hn::AndNot(later, going);
      at0 = hn::IfThenElse(hn::And(later, hn::Gt(side, zero)), hn::Mul(half, at0), hn::IfThenElse(earlier, here, at0));
      at1 = hn::IfThenElse(hn::And(earlier, hn::Lt(side, zero)), hn::Mul(half, at1), hn::IfThenElse(later, here, at1));
      end = hn::IfThenElse(later, meet, end), s = hn::IfThenElse(earlier, meet, s);
      side = hn::IfThenElse(later, hn::Set(d, 1.0f), hn::IfThenElse(earlier, hn::Set(d, -1.0f), side));
    }
    return meet;
  }

  /// The share of the way after which the share q of its depth is passed; tau at the begin, the middle and the end.
  static HWY_INLINE F way_of_depth(const F tau[3], F q) {
    const D d;
    const F zero = hn::Zero(d), half = hn::Set(d, 0.5f), least = hn::Set(d, 1e-30f);
    const F front = hn::Add(tau[0], tau[1]), back = hn::Add(tau[1], tau[2]);
    const F x = hn::Mul(q, hn::Add(front, back));
    const M in_front = hn::Le(x, front);
    // a s + (b - a) s^2 / 2 = rest / 2
    const F a = hn::IfThenElse(in_front, tau[0], tau[1]), b = hn::IfThenElse(in_front, tau[1], tau[2]);
    const F rest = hn::IfThenElse(in_front, x, hn::Sub(x, front)), sum = hn::Add(a, b);
    const F root = hn::Sqrt(hn::Max(zero, mul_add(a, a, hn::Mul(rest, hn::Sub(b, a)))));
    const F s = hn::Div(rest, hn::Max(hn::Add(a, root), least));
    return mul_add(half, hn::Min(hn::IfThenElse(hn::Gt(sum, zero), s, hn::Set(d, 1.0f)), hn::Set(d, 1.0f)),
                   hn::IfThenElse(in_front, zero, half));
  }

  /// What of a part is seen: how much nearer together than what it sends (as the variance), and how its colours change, times its share.
  struct Spread {
    F narrower, change[3];
    bool any_change;
  };
  /// Pieces::segment of rays/integrate.cpp. `line`: of the medium on which the part lies; null: that of each value. `lit(at, share,
  /// spread, r, g, b)` lights the colours and the share of what is mirrored, at the share `at` of the part.
  template <class Lit>
  HWY_INLINE void segment(M look, F here, F part, F depth, const F tau[3], F a, F b, F middle, F weight, const I* line, const Lit& lit) {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
    const M drawn = hn::And(look, hn::Gt(depth, zero));
    if (hn::AllFalse(d, drawn)) return;
    depth = hn::IfThenElseZero(drawn, depth);
    const F pass = exp_minus(depth);
    const F thin = hn::Mul(depth, neg_mul_add(depth, neg_mul_add(depth, hn::Set(d, 1.0f / 6), half), one));
    const F alpha = hn::IfThenElse(hn::Lt(depth, hn::Set(d, 0.02f)), thin, hn::Sub(one, pass));
    auto color = line ? medium.color(middle, *line) : medium.color(middle);
    F r = hn::Mul(color.r, alpha), g = hn::Mul(color.g, alpha), bl = hn::Mul(color.b, alpha);
    M deep = hn::And(drawn, hn::Gt(depth, hn::Set(d, 0.1f)));
    deep = hn::And(deep, hn::Gt(hn::Mul(hn::Min(depth, hn::Set(d, 6.0f)), most_hidden_), hn::Set(d, 12.0f)));
    Spread spread{one, {zero, zero, zero}, false};
    M covaries = deep;
    if constexpr (shaded) covaries = hn::Or(deep, hn::And(drawn, hn::Gt(hn::Mul(hn::Min(depth, one), most_covary_), one)));
    if (!hn::AllFalse(d, covaries)) {
      F hidden = hn::Add(mul_sub(half, alpha, hn::Div(alpha, hn::Max(depth, hn::Set(d, 0.05f)))), pass);
      const F series = hn::Mul(hn::Mul(depth, depth),
                               neg_mul_add(depth, neg_mul_add(depth, hn::Set(d, 1.0f / 80), hn::Set(d, 1.0f / 24)), hn::Set(d, 1.0f / 12)));
      hidden = hn::IfThenElseZero(deep, hn::IfThenElse(hn::Lt(depth, hn::Set(d, 0.2f)), series, hidden));
      const auto front = line ? medium.color(a, *line) : medium.color(a), back = line ? medium.color(b, *line) : medium.color(b);
      r = neg_mul_add(hn::Sub(back.r, front.r), hidden, r), g = neg_mul_add(hn::Sub(back.g, front.g), hidden, g);
      bl = neg_mul_add(hn::Sub(back.b, front.b), hidden, bl);
      const F per_alpha = hn::Div(one, hn::Max(alpha, hn::Set(d, 0.05f)));
      weight = hn::Sub(weight, hn::IfThenElseZero(deep, hn::Mul(hidden, per_alpha)));
      if constexpr (shaded) {
        // 12 / depth^2 - 12 exp(-depth) / alpha^2, by its series where that cancels.
        const F square = hn::Mul(depth, depth), per = hn::Div(hn::Set(d, 12.0f), hn::Max(square, one));
        const F closed = neg_mul_add(hn::Mul(hn::Set(d, 12.0f), pass), hn::Mul(per_alpha, per_alpha), per);
        const F thin_spread = neg_mul_add(square, neg_mul_add(square, hn::Set(d, 1.0f / 504), hn::Set(d, 0.05f)), one);
        // What lanes get must not depend on their neighbours.
        spread.narrower = hn::IfThenElse(covaries, hn::IfThenElse(hn::Lt(depth, one), thin_spread, closed), one);
        const F rise[3] = {hn::Sub(back.r, front.r), hn::Sub(back.g, front.g), hn::Sub(back.b, front.b)};
        for (int c = 0; c < 3; ++c) spread.change[c] = hn::IfThenElseZero(covaries, hn::Mul(alpha, rise[c]));
        spread.any_change = true;
      }
    }
    const F before = hn::IfThenElseZero(drawn, sum.pass);
    lit(weight, alpha, spread, r, g, bl);
    // Lanes that draw nothing may have been lit beside a hole.
    if constexpr (shaded) r = hn::IfThenElseZero(drawn, r), g = hn::IfThenElseZero(drawn, g), bl = hn::IfThenElseZero(drawn, bl);
    sum.r = mul_add(before, r, sum.r), sum.g = mul_add(before, g, sum.g), sum.b = mul_add(before, bl, sum.b);
    const F after = hn::Mul(sum.pass, pass);
    const M halved = hn::And(drawn, hn::And(hn::Lt(after, half), hn::Lt(sum.half_at, zero)));
    if (!hn::AllFalse(d, halved)) {
      // ln(2 pass) = 2 atanh z
      const F z = hn::Div(hn::Sub(sum.pass, half), hn::Add(sum.pass, half)), z2 = hn::Mul(z, z);
      const F log =
          hn::Mul(hn::Add(z, z), mul_add(z2, mul_add(z2, mul_add(z2, hn::Set(d, 1.0f / 7), hn::Set(d, 0.2f)), hn::Set(d, 1.0f / 3)), one));
      const F share = way_of_depth(tau, hn::Max(zero, hn::Min(hn::Div(log, hn::Max(depth, hn::Set(d, 1e-30f))), one)));
      sum.half_at = hn::IfThenElse(halved, mul_add(part, share, here), sum.half_at);
    }
    sum.pass = hn::IfThenElse(drawn, after, sum.pass);
  }

 private:
  CellLight<D, T, Axes> light;
  // The line of the medium on which each lane's value was last: most often it is there still.
  I at_;
  typename MediumLanes<D>::Line line_;
  F most_hidden_, most_covary_;
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
