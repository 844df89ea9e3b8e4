// SPDX-License-Identifier: Apache-2.0
// The integral within a tolerance along packets of rays: optics/integrate.cpp for a uniform grid, one ray per vector lane. Lanes go from
// cell to cell, each at its own pace; in a cell the field along the ray is a cubic, cut at the knots of the medium.
#include "render/volume/lattice/packet_rays.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/lattice/packets_tolerance.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/volume/lattice/packet_light_inl.h"
#include "render/volume/lattice/packets_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// exp_minus of optics/integrate.cpp.
template <class D>
HWY_INLINE hn::Vec<D> exp_minus_of(D d, hn::Vec<D> x) {
  const IntTag<D> di;
  const auto deep = hn::Ge(x, hn::Set(d, 87.0f));
  x = hn::Min(x, hn::Set(d, 87.0f));
  const auto k = to_int(d, hn::Add(hn::Mul(x, hn::Set(d, 1.44269504f)), hn::Set(d, 0.5f)));
  const auto kf = hn::ConvertTo(d, k);
  const auto r = hn::Neg(hn::Sub(hn::Sub(x, hn::Mul(kf, hn::Set(d, 0.693145752f))), hn::Mul(kf, hn::Set(d, 1.42860677e-6f))));
  auto sum = hn::Set(d, 1.0f / 5040);
  for (const float c : {1.0f / 720, 1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) sum = hn::Add(hn::Mul(sum, r), hn::Set(d, c));
  const auto power = hn::BitCast(d, hn::ShiftLeft<23>(hn::Sub(hn::Set(di, 127), k)));
  return hn::IfThenElseZero(hn::Not(deep), hn::Mul(sum, power));
}

/// The medium, ready for gathers.
template <class D>
struct MediumLanes {
  using F = hn::Vec<D>;
  using I = Int<D>;
  const Medium& medium;
  const Medium::Columns& columns;

  struct Line {
    F lo, hi, origin, at, slope, curve, twist;
    HWY_INLINE F tau(F v) const {
      const F x = hn::Sub(v, origin);
      return hn::Max(hn::Zero(D()), hn::Add(at, hn::Mul(x, hn::Add(slope, hn::Mul(x, hn::Add(curve, hn::Mul(x, twist)))))));
    }
    HWY_INLINE F slope_at(F v) const {
      const F x = hn::Sub(v, origin);
      return hn::Abs(hn::Add(slope, hn::Mul(x, hn::Add(hn::Add(curve, curve), hn::Mul(x, hn::Mul(hn::Set(D(), 3.0f), twist))))));
    }
    HWY_INLINE hn::Mask<D> dark() const {
      const F zero = hn::Zero(D());
      return hn::And(hn::And(hn::Eq(at, zero), hn::Eq(slope, zero)), hn::And(hn::Eq(curve, zero), hn::Eq(twist, zero)));
    }
  };
  /// As many lines as there are lanes fit a vector: then no gather is needed.
  bool few;
  F few_columns[6];
  HWY_INLINE explicit MediumLanes(const Medium& m) : medium(m), columns(m.columns()), few(m.lines().size() <= size_t(lanes_of<D>)) {
    const D d;
    const std::vector<float>* all[6] = {&columns.origin, &columns.hi, &columns.at, &columns.slope, &columns.curve, &columns.twist};
    for (int c = 0; c < 6; ++c) {
      alignas(64) float column[most_lanes] = {};
      if (few) std::copy(all[c]->begin(), all[c]->end(), column);
      few_columns[c] = hn::Load(d, column);
    }
  }
  HWY_INLINE Line line(I i) const {
    const D d;
    Line l;
    if (few) {
      const auto which = hn::IndicesFromVec(d, i);
      l.origin = hn::TableLookupLanes(few_columns[0], which), l.hi = hn::TableLookupLanes(few_columns[1], which);
      l.at = hn::TableLookupLanes(few_columns[2], which), l.slope = hn::TableLookupLanes(few_columns[3], which);
      l.curve = hn::TableLookupLanes(few_columns[4], which), l.twist = hn::TableLookupLanes(few_columns[5], which);
    } else {
      l.origin = hn::GatherIndex(d, columns.origin.data(), i), l.hi = hn::GatherIndex(d, columns.hi.data(), i);
      l.at = hn::GatherIndex(d, columns.at.data(), i), l.slope = hn::GatherIndex(d, columns.slope.data(), i);
      l.curve = hn::GatherIndex(d, columns.curve.data(), i), l.twist = hn::GatherIndex(d, columns.twist.data(), i);
    }
    l.lo = hn::IfThenElse(hn::RebindMask(d, hn::Eq(i, hn::Zero(IntTag<D>()))), hn::Set(d, -HUGE_VALF), l.origin);
    return l;
  }
  HWY_INLINE I line_of(F v) const {
    const D d;
    const IntTag<D> di;
    v = hn::Min(v, hn::Set(d, 3e38f));  // the last line ends at infinity
    F at = hn::Mul(hn::Sub(v, hn::Set(d, medium.slice_lo())), hn::Set(d, medium.per_slice()));
    at = hn::IfThenElseZero(hn::Ge(at, hn::Zero(d)), hn::Min(at, hn::Set(d, float(Medium::slices))));
    I i = hn::And(gather_words(d, medium.first_lines(), hn::ShiftLeft<1>(to_int(d, at))), hn::Set(di, 0xFFFF));
    for (;;) {
      const auto beyond =
          hn::Le(few ? hn::TableLookupLanes(few_columns[1], hn::IndicesFromVec(d, i)) : hn::GatherIndex(d, columns.hi.data(), i), v);
      if (hn::AllFalse(d, beyond)) return i;
      i = hn::Sub(i, hn::VecFromMask(di, hn::RebindMask(di, beyond)));
    }
  }
  /// The largest of a column over the lines a .. b, from the table of powers of two.
  HWY_INLINE F most(const std::vector<float>& table, I a, I b) const {
    const D d;
    const IntTag<D> di;
    const I count = hn::Add(hn::Sub(b, a), hn::Set(di, 1));
    const I k = hn::Sub(hn::ShiftRight<23>(hn::BitCast(di, hn::ConvertTo(d, count))), hn::Set(di, 127));
    const I row = hn::Mul(k, hn::Set(di, int(columns.hi.size())));
    const I width = to_int(d, hn::BitCast(d, hn::ShiftLeft<23>(hn::Add(k, hn::Set(di, 127)))));
    return hn::Max(hn::GatherIndex(d, table.data(), hn::Add(row, a)),
                   hn::GatherIndex(d, table.data(), hn::Add(row, hn::Sub(hn::Add(b, hn::Set(di, 1)), width))));
  }
  struct Color {
    F r, g, b;
  };
  HWY_INLINE Color color(F v) const {
    const D d;
    const IntTag<D> di;
    F at = hn::Add(hn::Mul(hn::Sub(v, hn::Set(d, medium.first_node())), hn::Set(d, medium.per_node())), hn::Set(d, 0.5f));
    at = hn::IfThenElseZero(hn::Ge(at, hn::Zero(d)), hn::Min(at, hn::Set(d, float(Medium::nodes))));
    const I byte = hn::ShiftLeft<3>(to_int(d, at));
    const I rg = gather_words(d, medium.colors(), byte), b = gather_words(d, medium.colors(), hn::Add(byte, hn::Set(di, 4)));
    const F per = hn::Set(d, 1.0f / 65535);
    const I low = hn::Set(di, 0xFFFF);
    const hn::RebindToUnsigned<IntTag<D>> du;
    const I g = hn::BitCast(di, hn::ShiftRight<16>(hn::BitCast(du, rg)));
    return {hn::Mul(hn::ConvertTo(d, hn::And(rg, low)), per), hn::Mul(hn::ConvertTo(d, g), per),
            hn::Mul(hn::ConvertTo(d, hn::And(b, low)), per)};
  }
};

/// a + b s + c s^2 + e s^3.
template <class D>
struct Cubic {
  hn::Vec<D> a, b, c, e, last;  // last: at s = 1
  HWY_INLINE hn::Vec<D> at(hn::Vec<D> s) const { return hn::Add(a, hn::Mul(s, hn::Add(b, hn::Mul(s, hn::Add(c, hn::Mul(s, e)))))); }
};

/// The trilinear field of a cell along the way from + s * way, corners by rows.
template <class D>
HWY_INLINE Cubic<D> along_way(D d, const Pair<D>& p00, const Pair<D>& p01, const Pair<D>& p10, const Pair<D>& p11, const hn::Vec<D> from[3],
                              const hn::Vec<D> way[3]) {
  using F = hn::Vec<D>;
  struct Linear {
    F a, b;
  };
  struct Square {
    F a, b, c;
  };
  const auto x = [&](const Pair<D>& p) HWY_ATTR {
    const F rise = hn::Sub(p.b, p.a);
    return Linear{hn::Add(p.a, hn::Mul(from[0], rise)), hn::Mul(way[0], rise)};
  };
  const auto y = [&](const Linear& p, const Linear& q) HWY_ATTR {
    const F rise = hn::Sub(q.a, p.a), bend = hn::Sub(q.b, p.b);
    return Square{hn::Add(p.a, hn::Mul(from[1], rise)), hn::Add(hn::Add(p.b, hn::Mul(from[1], bend)), hn::Mul(way[1], rise)),
                  hn::Mul(way[1], bend)};
  };
  const Square p = y(x(p00), x(p01)), q = y(x(p10), x(p11));
  const F da = hn::Sub(q.a, p.a), db = hn::Sub(q.b, p.b), dc = hn::Sub(q.c, p.c);
  Cubic<D> f;
  f.a = hn::Add(p.a, hn::Mul(from[2], da));
  f.b = hn::Add(hn::Add(p.b, hn::Mul(from[2], db)), hn::Mul(way[2], da));
  f.c = hn::Add(hn::Add(p.c, hn::Mul(from[2], dc)), hn::Mul(way[2], db));
  f.e = hn::Mul(way[2], dc);
  f.last = hn::Add(hn::Add(f.a, f.b), hn::Add(f.c, f.e));
  return f;
}

/// What is gathered so far, and where half of the light was gone.
template <class D>
struct Gathering {
  hn::Vec<D> r, g, b, pass, half_at;
  HWY_INLINE Gathering() {
    const D d;
    r = g = b = hn::Zero(d), pass = hn::Set(d, 1.0f), half_at = hn::Set(d, -1.0f);
  }
};

template <class D, class T, bool shaded>
class TolerantPacket {
  using F = hn::Vec<D>;
  using I = Int<D>;
  using M = hn::Mask<D>;

 public:
  HWY_INLINE TolerantPacket(const PacketPlan& plan, const RayPacket& rays)
      : plan_(plan), v_(plan.volume), source_(v_.voxels), medium_(*plan.medium), light_(plan, rays) {
    const D d;
    for (int a = 0; a < 3; ++a) {
      start_[a] = hn::Load(d, rays.entry[a]), along_[a] = hn::Load(d, rays.along[a]);
      still_[a] = hn::Eq(along_[a], hn::Zero(d)), up_[a] = hn::Gt(along_[a], hn::Zero(d));
      per_along_[a] = hn::IfThenElseZero(hn::Not(still_[a]), hn::Div(hn::Set(d, 1.0f), along_[a]));
    }
    end_ = hn::Load(d, rays.length), sum_.pass = hn::Load(d, rays.before);
    at_ = hn::Zero(IntTag<D>());
    line_ = medium_.line(at_);
  }

  HWY_INLINE void run(PacketResult& result, const RayPacket& rays) {
    const D d;
    const IntTag<D> di;
    const I one = hn::Set(di, 1), zero = hn::Zero(di);
    const F stop = hn::Set(d, plan_.budget.stop_below);
    const auto& bricks = v_.fine().dims;
    const bool skip = plan_.knobs.skip_empty && v_.any_empty;
    I cell[3];
    F t = hn::Zero(d);
    // Cells -1 and n-1 are the halves beyond the outermost samples.
    for (int a = 0; a < 3; ++a)
      cell[a] = hn::Min(hn::Max(to_int(d, hn::Floor(start_[a])), hn::Set(di, -1)), hn::Add(source_.last_cell[a], one));
    for (;;) {
      const M on = hn::And(hn::Lt(t, end_), hn::Ge(sum_.pass, stop));
      if (hn::AllFalse(d, on)) break;
      I inside[3], brick[3];
      for (int a = 0; a < 3; ++a) {
        inside[a] = hn::Min(hn::Max(cell[a], zero), source_.last_cell[a]);
        brick[a] = hn::ShiftRight<FineBricks::shift>(inside[a]);
      }
      I free = zero;
      if (skip) {
        const I id = hn::Add(
            brick[0], hn::Add(hn::Mul(brick[1], hn::Set(di, int(bricks[0]))), hn::Mul(brick[2], hn::Set(di, int(bricks[0] * bricks[1])))));
        free = hn::And(gather_words(d, v_.distance.data(), id), hn::Set(di, 255));
      }
      const auto leaps = hn::Gt(free, zero);
      const M leaping = hn::And(on, hn::RebindMask(d, leaps));
      // The side through which each lane leaves its cell, or the cube of bricks nearer than what is drawn.
      F leave = end_, at[3];
      I side[3];
      for (int a = 0; a < 3; ++a) {
        const auto up = hn::RebindMask(di, up_[a]);
        const I reach = hn::ShiftLeft<FineBricks::shift>(hn::Add(brick[a], hn::IfThenElse(up, free, hn::Sub(one, free))));
        side[a] = hn::IfThenElse(leaps, reach, hn::Add(cell[a], hn::IfThenElse(up, one, zero)));
        F there = hn::Mul(hn::Sub(hn::ConvertTo(d, side[a]), start_[a]), per_along_[a]);
        // Beyond the outermost bricks there is nothing else.
        const auto open = hn::And(leaps, hn::Or(hn::Lt(side[a], one), hn::Gt(side[a], source_.last_cell[a])));
        there = hn::IfThenElse(hn::Or(still_[a], hn::RebindMask(d, open)), hn::Set(d, HUGE_VALF), hn::Max(there, t));
        at[a] = there, leave = hn::Min(leave, there);
      }
      const M look = hn::And(hn::AndNot(leaping, on), hn::Gt(leave, t));
      if (!hn::AllFalse(d, look)) cross(inside, t, leave, look);
      for (int a = 0; a < 3; ++a) {
        const auto up = hn::RebindMask(di, up_[a]);
        const auto through = hn::RebindMask(di, hn::Le(at[a], leave));
        const I beyond = hn::Sub(side[a], hn::IfThenElse(up, zero, one));
        I next = cell[a];
        if (!hn::AllFalse(d, leaping)) {
          // Inside the cube along the other axes, and never back.
          const I here = to_int(d, hn::Floor(hn::Add(start_[a], hn::Mul(along_[a], leave))));
          const I forth = hn::IfThenElse(up, hn::Max(cell[a], hn::Min(here, hn::Sub(beyond, one))),
                                         hn::Min(cell[a], hn::Max(here, hn::Add(beyond, one))));
          const auto open = hn::Ge(at[a], hn::Set(d, HUGE_VALF));
          const I free_way = hn::Min(hn::Max(here, hn::Set(di, -1)), hn::Add(source_.last_cell[a], one));
          const I leapt = hn::IfThenElse(hn::RebindMask(di, open), hn::IfThenElse(hn::RebindMask(di, still_[a]), cell[a], free_way), forth);
          next = hn::IfThenElse(leaps, leapt, next);
        }
        cell[a] = hn::IfThenElse(through, beyond, next);
      }
      t = leave;
    }
    store(result, rays);
  }

 private:
  /// One cell per lane: its cubic, and what the medium makes of it.
  HWY_INLINE void cross(const I inside[3], F t, F leave, M look) {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const I corner = source_.offset(inside[0], inside[1], inside[2]);
    F from[3], way[3];
    for (int a = 0; a < 3; ++a) {
      const F base = hn::Sub(start_[a], hn::ConvertTo(d, inside[a]));
      from[a] = hn::Max(zero, hn::Min(hn::Add(base, hn::Mul(along_[a], t)), one));
      way[a] = hn::Sub(hn::Max(zero, hn::Min(hn::Add(base, hn::Mul(along_[a], leave)), one)), from[a]);
    }
    const I above = hn::Add(corner, source_.layer);
    const Pair<D> p00 = source_.pair(corner), p01 = source_.pair(hn::Add(corner, source_.row));
    const Pair<D> p10 = source_.pair(above), p11 = source_.pair(hn::Add(above, source_.row));
    // No place in the cell lies outside the range of its corners.
    const F least = hn::Min(hn::Min(hn::Min(p00.a, p00.b), hn::Min(p01.a, p01.b)), hn::Min(hn::Min(p10.a, p10.b), hn::Min(p11.a, p11.b)));
    const F largest = hn::Max(hn::Max(hn::Max(p00.a, p00.b), hn::Max(p01.a, p01.b)), hn::Max(hn::Max(p10.a, p10.b), hn::Max(p11.a, p11.b)));
    const M clear_line = line_.dark();
    if (hn::AllFalse(d, hn::AndNot(hn::And(clear_line, hn::And(hn::Ge(least, line_.lo), hn::Le(largest, line_.hi))), look))) return;
    const Cubic<D> f = along_way(d, p00, p01, p10, p11, from, way);
    // The hull of the cubic's Bernstein coefficients.
    const F third = hn::Set(d, 1.0f / 3), b1 = hn::Add(f.a, hn::Mul(f.b, third)), b2 = hn::Add(b1, hn::Mul(hn::Add(f.b, f.c), third));
    const F lo = hn::Min(hn::Min(f.a, b1), hn::Min(b2, f.last)), hi = hn::Max(hn::Max(f.a, b1), hn::Max(b2, f.last));
    look = hn::And(look, hn::Eq(f.last, f.last));  // no hole
    const M strange = hn::AndNot(hn::And(hn::Ge(f.a, line_.lo), hn::Le(f.a, line_.hi)), look);
    if (!hn::AllFalse(d, strange)) at_ = medium_.line_of(f.a), line_ = medium_.line(at_);
    const M same = hn::And(hn::Ge(lo, line_.lo), hn::Le(hi, line_.hi));
    const M dark = hn::And(same, line_.dark());
    look = hn::AndNot(dark, look);
    if (hn::AllFalse(d, look)) return;
    const Pair<D> rows[4] = {p00, p01, p10, p11};
    integrate(f, lo, hi, same, corner, inside, rows, from, way, t, hn::Sub(leave, t), look);
  }

  HWY_INLINE void integrate(const Cubic<D>& f, F lo, F hi, M same, I corner, const I inside[3], const Pair<D> rows[4], const F from[3],
                            const F way[3], F t, F length, M look) {
    const D d;
    const IntTag<D> di;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
    const Medium& m = medium_.medium;
    const typename MediumLanes<D>::Line& line = line_;
    const float tolerance = float(plan_.budget.tolerance);
    // Of the cubic: a + b/2 + c/3 + e/4.
    const F mean = hn::Add(hn::Add(f.a, hn::Mul(half, f.b)), hn::Add(hn::Mul(hn::Set(d, 1.0f / 3), f.c), hn::Mul(hn::Set(d, 0.25f), f.e)));
    F tau_mean = line.tau(mean), most = hn::Max(hn::Max(line.tau(lo), line.tau(hi)), tau_mean);
    F slope = hn::Max(line.slope_at(lo), line.slope_at(hi));
    if (!hn::AllFalse(d, hn::AndNot(same, look))) {
      const I first = medium_.line_of(lo), last = medium_.line_of(hi);
      most = hn::IfThenElse(same, most, medium_.most(medium_.columns.most_tau, first, last));
      slope = hn::IfThenElse(same, slope, medium_.most(medium_.columns.most_slope, first, last));
      tau_mean = hn::IfThenElse(same, tau_mean, medium_.line(medium_.line_of(mean)).tau(mean));
      look = hn::And(look, hn::Gt(most, zero));
      if (hn::AllFalse(d, look)) return;
    }
    // The errors of optics/integrate.cpp, Pieces::whole.
    const F pass = sum_.pass, taken = hn::Min(one, hn::Mul(length, most)), range = hn::Sub(hi, lo);
    const F widths = hn::Mul(range, hn::Set(d, 1 / m.color_width())), change = hn::Min(one, hn::Mul(range, hn::Set(d, m.color_slope())));
    const F beyond = hn::Max(hn::Sub(hi, hn::Max(f.a, f.last)), hn::Sub(hn::Min(f.a, f.last), lo));
    const F deep = hn::Mul(hn::Mul(hn::Mul(length, length), hn::Mul(most, slope)), hn::Mul(range, hn::Set(d, 0.05f)));
    F error = hn::Mul(hn::Mul(taken, hn::Set(d, 0.25f * tolerance)), hn::Mul(widths, widths));
    error = hn::Add(error, hn::Mul(change, hn::Min(one, deep)));
    error = hn::Add(error, hn::IfThenElseZero(hn::Not(same), hn::Mul(beyond, hn::Mul(length, slope))));
    error = hn::Mul(error, pass);
    const F share = hn::Mul(pass, hn::Min(one, hn::Mul(length, tau_mean)));
    const F allowed = hn::Mul(hn::Set(d, tolerance),
                              hn::Add(hn::Mul(length, hn::Set(d, float(0.3 / plan_.budget.length))), hn::Mul(share, hn::Set(d, 0.4f))));
    if constexpr (shaded) {
      light_.cell(source_, corner, inside, rows);
      error = hn::Max(error, light_.error(from, way, hn::Mul(pass, taken)));
    }
    F count = one, per_count = one, end = one, target = f.last;
    if (!hn::AllFalse(d, hn::And(look, hn::Gt(error, allowed)))) {
      count = hn::Max(one, hn::Min(hn::Ceil(hn::Sqrt(hn::Div(error, hn::Max(allowed, hn::Set(d, 1e-30f))))), hn::Set(d, 64.0f)));
      per_count = hn::Div(one, count), end = per_count;
      target = hn::IfThenElse(hn::Eq(count, one), f.last, f.at(per_count));
    }
    const F stop = hn::Set(d, plan_.budget.stop_below);
    most_hidden_ = hn::Mul(range, hn::Set(d, m.color_slope() / (0.2f * tolerance)));

    // Pieces, cut where the value meets the knots.
    F k = zero, v = f.a, s = zero;
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
        F meet = hn::Add(s, hn::Mul(hn::Sub(knot, v), run));
        for (int i = 0; i < 2; ++i) meet = hn::Max(s, hn::Min(hn::Sub(meet, hn::Mul(hn::Sub(f.at(meet), knot), run)), end));
        to = hn::IfThenElse(cut, meet, to), next = hn::IfThenElse(cut, knot, next);
      }
      const F middle = f.at(hn::Mul(half, hn::Add(s, to))), part = hn::Mul(length, hn::Sub(to, s));
      const F t0 = l.tau(v), tm = hn::Mul(hn::Set(d, 4.0f), l.tau(middle)), t1 = l.tau(next), all = hn::Add(hn::Add(t0, tm), t1);
      const F per_all = hn::Div(one, hn::Max(all, hn::Set(d, 1e-37f)));
      const F by_emission = hn::Mul(hn::Add(hn::Add(hn::Mul(t0, v), hn::Mul(tm, middle)), hn::Mul(t1, next)), per_all);
      const F weight = hn::Mul(hn::Add(hn::Mul(half, tm), t1), per_all);
      segment(look, hn::Add(t, hn::Mul(length, s)), part, hn::Mul(part, hn::Mul(all, hn::Set(d, 1.0f / 6))), v, next, by_emission, weight,
              t, length, from, way);
      // On to the next line, or to the next piece.
      k = hn::IfThenElse(ends, hn::Add(k, one), k);
      look = hn::And(look, hn::And(hn::Lt(k, count), hn::Ge(sum_.pass, stop)));
      if (hn::AllFalse(d, look)) return;
      v = next, s = to;
      if (!hn::AllFalse(d, cut)) {
        at_ = hn::IfThenElse(hn::RebindMask(di, cut), hn::Add(at_, hn::IfThenElse(hn::RebindMask(di, up), hn::Set(di, 1), hn::Set(di, -1))),
                             at_);
        l = medium_.line(at_);
      }
      const F after = hn::Add(k, one), there = hn::Mul(after, per_count);
      const M final_piece = hn::Ge(after, count);
      end = hn::IfThenElse(ends, hn::IfThenElse(final_piece, one, there), end);
      target = hn::IfThenElse(ends, hn::IfThenElse(final_piece, f.last, f.at(there)), target);
    }
  }

  /// Pieces::segment of optics/integrate.cpp.
  HWY_INLINE void segment(M look, F here, F part, F depth, F a, F b, F middle, F weight, F t, F length, const F from[3], const F way[3]) {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
    const M drawn = hn::And(look, hn::Gt(depth, zero));
    if (hn::AllFalse(d, drawn)) return;
    depth = hn::IfThenElseZero(drawn, depth);
    const F pass = exp_minus_of(d, depth);
    const F thin = hn::Mul(depth, hn::Sub(one, hn::Mul(depth, hn::Sub(half, hn::Mul(depth, hn::Set(d, 1.0f / 6))))));
    const F alpha = hn::IfThenElse(hn::Lt(depth, hn::Set(d, 0.02f)), thin, hn::Sub(one, pass));
    auto color = medium_.color(middle);
    F r = hn::Mul(color.r, alpha), g = hn::Mul(color.g, alpha), bl = hn::Mul(color.b, alpha);
    const M deep = hn::And(hn::And(drawn, hn::Gt(depth, hn::Set(d, 0.1f))),
                           hn::Gt(hn::Mul(hn::Min(depth, hn::Set(d, 6.0f)), most_hidden_), hn::Set(d, 12.0f)));
    if (!hn::AllFalse(d, deep)) {
      F hidden = hn::Add(hn::Sub(hn::Mul(half, alpha), hn::Div(alpha, hn::Max(depth, hn::Set(d, 0.05f)))), pass);
      const F series =
          hn::Mul(hn::Mul(depth, depth),
                  hn::Sub(hn::Set(d, 1.0f / 12), hn::Mul(depth, hn::Sub(hn::Set(d, 1.0f / 24), hn::Mul(depth, hn::Set(d, 1.0f / 80))))));
      hidden = hn::IfThenElseZero(deep, hn::IfThenElse(hn::Lt(depth, hn::Set(d, 0.2f)), series, hidden));
      const auto front = medium_.color(a), back = medium_.color(b);
      r = hn::Sub(r, hn::Mul(hn::Sub(back.r, front.r), hidden)), g = hn::Sub(g, hn::Mul(hn::Sub(back.g, front.g), hidden));
      bl = hn::Sub(bl, hn::Mul(hn::Sub(back.b, front.b), hidden));
      weight = hn::Sub(weight, hn::IfThenElseZero(deep, hn::Div(hidden, hn::Max(alpha, hn::Set(d, 0.05f)))));
    }
    if constexpr (shaded) {
      const F s = hn::Div(hn::Sub(hn::Add(here, hn::Mul(part, weight)), t), hn::Max(length, hn::Set(d, 1e-30f)));
      const auto lit = light_.at(from, way, s);
      const F flash = hn::Mul(lit.specular, alpha);
      r = hn::Add(hn::Mul(r, lit.diffuse), flash), g = hn::Add(hn::Mul(g, lit.diffuse), flash),
      bl = hn::Add(hn::Mul(bl, lit.diffuse), flash);
    }
    const F before = hn::IfThenElseZero(drawn, sum_.pass);
    sum_.r = hn::Add(sum_.r, hn::Mul(before, r)), sum_.g = hn::Add(sum_.g, hn::Mul(before, g)),
    sum_.b = hn::Add(sum_.b, hn::Mul(before, bl));
    const F after = hn::Mul(sum_.pass, pass);
    const M halved = hn::And(drawn, hn::And(hn::Lt(after, half), hn::Lt(sum_.half_at, zero)));
    if (!hn::AllFalse(d, halved)) {
      const F share = hn::Min(one, hn::Div(hn::Sub(sum_.pass, half), hn::Max(hn::Sub(sum_.pass, after), hn::Set(d, 1e-30f))));
      sum_.half_at = hn::IfThenElse(halved, hn::Add(here, hn::Mul(part, share)), sum_.half_at);
    }
    sum_.pass = hn::IfThenElse(drawn, after, sum_.pass);
  }

  HWY_INLINE void store(PacketResult& result, const RayPacket& rays) const {
    const D d;
    alignas(64) float half_at[most_lanes];
    hn::Store(sum_.r, d, result.r), hn::Store(sum_.g, d, result.g), hn::Store(sum_.b, d, result.b);
    hn::Store(sum_.pass, d, result.transmittance), hn::Store(sum_.half_at, d, half_at);
    for (size_t n = 0; n < hn::Lanes(d); ++n) result.surface[n] = half_at[n] >= 0 ? rays.enter[n] + double(half_at[n]) : -1;
  }

  const PacketPlan& plan_;
  const Volume& v_;
  const Source<D, T> source_;
  const MediumLanes<D> medium_;
  CellLight<D, T> light_;
  F start_[3], along_[3], per_along_[3], end_;
  M still_[3], up_[3];
  Gathering<D> sum_;
  // The line of the medium on which each lane's value was last: most often it is there still.
  I at_;
  typename MediumLanes<D>::Line line_;
  F most_hidden_;  // what the front of a cell can hide of its change of colour, in a fifth of the tolerance
};

template <class D, class T, bool shaded>
HWY_NOINLINE void cast_all(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  constexpr int lanes = lanes_of<D>, width = packet_width<D>, height = lanes / width;
  RayPacket rays;
  PacketResult result;
  for (int y = y0; y < y1; y += height)
    for (int x = x0; x < x1; x += width) {
      if (!set_up<D>(plan, x, y, x1, y1, frame, rays)) continue;
      TolerantPacket<D, T, shaded> packet(plan, rays);
      packet.run(result, rays);
      put(plan, rays, result, lanes, frame);
    }
}

template <class D>
HWY_INLINE void cast_with(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  const bool shaded = plan.volume.shaded;
  switch (plan.volume.voxels.array.type()) {
    case ElementType::u8: return (shaded ? cast_all<D, uint8_t, true> : cast_all<D, uint8_t, false>)(plan, x0, y0, x1, y1, frame);
    case ElementType::i8: return (shaded ? cast_all<D, int8_t, true> : cast_all<D, int8_t, false>)(plan, x0, y0, x1, y1, frame);
    case ElementType::u16: return (shaded ? cast_all<D, uint16_t, true> : cast_all<D, uint16_t, false>)(plan, x0, y0, x1, y1, frame);
    case ElementType::i16: return (shaded ? cast_all<D, int16_t, true> : cast_all<D, int16_t, false>)(plan, x0, y0, x1, y1, frame);
    default: return (shaded ? cast_all<D, float, true> : cast_all<D, float, false>)(plan, x0, y0, x1, y1, frame);
  }
}

void cast_in_packets(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  cast_with<hn::CappedTag<float, most_lanes>>(plan, x0, y0, x1, y1, frame);
}

#if HWY_ONCE
void cast_singly(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  cast_with<hn::CappedTag<float, 1>>(plan, x0, y0, x1, y1, frame);
}
#endif

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(cast_in_packets);

bool in_tolerant_packets(const PacketPlan& plan) {
  const Volume& v = plan.volume;
  const size_t bytes = v.voxels.array.bytes();
  const bool offsets_fit = bytes >= 4 && bytes < (size_t(1) << 31) && v.voxels.array.count() < (size_t(1) << 29);
  const float power = plan.material.power;
  return v.direct && plan.medium->linear() && offsets_fit && plan.lamps.size() <= PacketPlan::most_lamps && power == std::floor(power) &&
         power >= 0 && power <= 4096;
}

void cast_tile(const PacketPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  if (plan.knobs.simd) return HWY_DYNAMIC_DISPATCH(cast_in_packets)(plan, x0, y0, x1, y1, frame);
  return HWY_STATIC_DISPATCH(cast_singly)(plan, x0, y0, x1, y1, frame);
}

}  // namespace sg::volume
#endif
