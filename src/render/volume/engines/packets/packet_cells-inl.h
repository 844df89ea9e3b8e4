// SPDX-License-Identifier: Apache-2.0
// Cells that the lanes of a packet cross, integrated within a tolerance: in a cell the field along the ray is a cubic, cut at the knots of
// the medium.
#if defined(SG_PACKET_CELLS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_CELLS_INL_H
#undef SG_PACKET_CELLS_INL_H
#else
#define SG_PACKET_CELLS_INL_H
#endif

#include "render/volume/engines/packets/packet_cell_light-inl.h"
#include "render/volume/engines/packets/packet_cubic-inl.h"
#include "render/volume/engines/packets/packet_medium-inl.h"
#include "render/volume/engines/packets/packet_scattered-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// What is gathered so far, and where half of the light was gone.
template <class D>
struct Gathering {
  Float<D> r, g, b, pass, half_at;
  HWY_INLINE Gathering() {
    const D d;
    r = g = b = set(d, 0), pass = set(d, 1.0f), half_at = set(d, -1.0f);
  }
};

/// The rays of a packet in their lattice.
template <class D, class T, class Axes>
struct RayLanes {
  using F = Float<D>;
  using I = Int<D>;
  using M = Mask<D>;

  const IntegralPlan& plan;
  const Source<D, T> source;
  const Axes axes;
  F start[3], along[3];  ///< in q: where the rays enter, and one world length
  Gathering<D> sum;

  template <class Plan>
  HWY_INLINE RayLanes(const Plan& p, const RayPacket& rays) : plan(p), source(p.volume.voxels, p.volume.within_samples()), axes(p, source) {
    const D d;
    // Rays that miss stay where there are samples.
    const M meets = hn::Load(d, rays.length) > 0;
    const auto of_meeting = [&](const float* from) HWY_ATTR { return only(meets, hn::Load(d, from)); };
    for (int a = 0; a < 3; ++a) start[a] = of_meeting(rays.entry[a]), along[a] = of_meeting(rays.along[a]);
  }
  /// The way from t to `leave` through a cell each, in shares of its edges.
  HWY_INLINE void way_through(const I cell[3], F t, F leave, F from[3], F way[3]) const {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f);
    for (int a = 0; a < 3; ++a) {
      const auto shares = axes.shares(a, cell[a], start[a]);
      from[a] = max(zero, min(shares.at(along[a], t), one));
      way[a] = max(zero, min(shares.at(along[a], leave), one)) - from[a];
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
  const ScatteredLanes<D> scattered;

  template <class Plan>
  HWY_INLINE PacketCells(const Plan& p, const RayPacket& rays)
      : Rays(p, rays),
        medium(*p.medium),
        lighting(p.volume, p.light, rays),
        scattered(p.scattered, rays, source.loads),
        light(lighting, axes) {
    at_ = set(IntTag<D>(), 0);
    line_ = medium.line(at_);
  }

  /// Sets the bounds by which segment() tells whether self-occlusion counts: how much colour that changes with the value, by `range`, and
  /// with the light, by `lightening`, the front of a segment may hide, in fifths of the tolerance. `covary`: the change of light by which
  /// colours are multiplied as they change; 0 where a segment has one light.
  HWY_INLINE void may_hide(F range, F lightening, F covary) {
    const D d;
    const F per = set(d, 1 / (0.2f * float(plan.budget.tolerance))), recolored = range * medium.medium.color_slope();
    F change = recolored + lightening;
    if (medium.medium.pieced()) change = max(change, 1.0f);
    most_hidden_ = change * per, most_covary_ = recolored * covary * (per * (1.0f / 3));
  }

  /// One cell per lane, from t to `leave`: along the ray the trilinear field is a cubic, which is integrated.
  HWY_INLINE void cross(const I inside[3], F t, F leave, M look) {
    // The ray in the cell, and the samples at its corners.
    F from[3], way[3];
    this->way_through(inside, t, leave, from, way);
    Pair<D> rows[4];
    source.corners(source.offset(inside[0], inside[1], inside[2]), rows);
    const auto &p00 = rows[0], &p01 = rows[1], &p10 = rows[2], &p11 = rows[3];
    // Empty cells: no value in a cell lies outside the range of its corners.
    const F least = min(min(min(p00.a, p00.b), min(p01.a, p01.b)), min(min(p10.a, p10.b), min(p11.a, p11.b)));
    const F largest = max(max(max(p00.a, p00.b), max(p01.a, p01.b)), max(max(p10.a, p10.b), max(p11.a, p11.b)));
    const M clear_line = line_.dark();
    if (none(look & !(clear_line & ((least >= line_.lo) & (largest <= line_.hi))))) return;
    // The cubic with its bounds, and the line of the medium where it begins.
    const Cubic<D> f = along_way(rows, from, way);
    F lo, hi;
    f.hull(lo, hi);
    look = look & (f.last == f.last);  // no hole
    const M off_line = look & !((f.a >= line_.lo) & (f.a <= line_.hi));
    // Only these: on a knot either line would do, and which it is must not depend on the other lanes.
    if (any(off_line)) at_ = select(off_line, medium.line_of(f.a), at_), line_ = medium.line(at_);
    const M same = (lo >= line_.lo) & (hi <= line_.hi);
    const M dark = same & line_.dark();
    look = look & !dark;
    if (none(look)) return;
    integrate(f, lo, hi, same, inside, from, way, t, leave - t, look);
  }

  /// The integral over a cell. `lo`, `hi` bound the values; `same`: they lie on one line of the medium. Estimates the error of one piece
  /// first, takes as many pieces as the tolerance asks for, and cuts them at the knots of the medium and at the kinks of the light. Out of
  /// line: it is long, and inlined it would slow the way to it.
  HWY_NOINLINE void integrate(const Cubic<D>& f, F lo, F hi, M same, [[maybe_unused]] const I inside[3], const F from[3], const F way[3],
                              F t, F length, M look) {
    const D d;
    const IntTag<D> di;
    const F zero = set(d, 0), one = set(d, 1.0f), half = set(d, 0.5f);
    const Medium& m = medium.medium;
    const typename MediumLanes<D>::Line& line = line_;
    const float tolerance = float(plan.budget.tolerance);
    // Extinction on the way: mean, largest, steepest. The mean of the cubic is a + b/2 + c/3 + e/4.
    const F mean = mul_add(half, f.b, f.a) + mul_add(0.25f, f.e, 1.0f / 3 * f.c);
    F mean_sigma_t = line.sigma_t(mean), most = max(max(line.sigma_t(lo), line.sigma_t(hi)), mean_sigma_t);
    F slope = max(line.slope_at(lo), line.slope_at(hi));
    M abrupt = hn::MaskFromVec(zero);  // lanes in which the medium jumps between the values
    if (any(look & !same)) {
      const I first = medium.line_of(lo), last = medium.line_of(hi);
      most = select(same, most, medium.most(medium.columns.most_tau, first, last));
      slope = select(same, slope, medium.most(medium.columns.most_slope, first, last));
      mean_sigma_t = select(same, mean_sigma_t, medium.line(medium.line_of(mean)).sigma_t(mean));
      look = look & (most > zero);
      if (none(look)) return;
      if (m.any_abrupt()) abrupt = medium.abrupt(first, last) & !same;
    }
    // Error of the whole as one piece, and the share of the tolerance allowed: Pieces::whole of rays/integrate.cpp.
    const F pass = sum.pass, depth = length * most, taken = min(one, depth), range = hi - lo;
    const F color_slope = set(d, m.color_slope());
    const F widths = range * (1 / m.color_width()), change = min(one, range * color_slope);
    const F bend = max(abs(f.c), abs(mul_add(3.0f, f.e, f.c)));
    const F recolored = taken * min(1e6f, bend * color_slope), tilt = length * slope;
    const F deep = depth * tilt * (range * 0.05f);
    const F deeper = min(1.0f / 6, depth * depth * (1.0f / 360));
    const F front = mul_add(min(depth, 8.0f), 0.0625f * tolerance, 0.25f * tolerance);
    F error = taken * front * (widths * widths);
    error = mul_add(change, min(one, deep), error);
    error = mul_add(recolored, deeper, error) * pass;
    const F fourth = mul_add(abs(f.e), range + range, bend * bend);
    const F leaning = min(taken * 120.0f, length * medium.leaning(slope, range, bend, abs(f.e)));
    const F uneven = pass * (1.0f / 120) * (min(one, fourth * (tilt * color_slope)) + leaning);
    const F share = pass * min(one, length * mean_sigma_t);
    const F allowed = tolerance * mul_add(share, 0.4f, length * float(0.3 / plan.budget.length));
    // Knots: turns of the value between them matter where it goes far enough beyond.
    F close = zero;  // so near to a knot a value counts as that
    M turning = abrupt;
    bool any_turn = false;
    if (any(look & !same)) {
      const F spoilt = pass * mul_add(taken, color_slope, tilt);
      close = only(!abrupt, allowed * 0.05f / max(spoilt, 1e-30f));
      const F beyond = max(hi - max(f.a, f.last), min(f.a, f.last) - lo);
      turning = abrupt | ((beyond * spoilt > allowed * 0.1f) & !same);
      any_turn = any(look & turning);
    }
    constexpr int most_kinks = shaded ? CellLight<D, T, Axes>::most_jumps : 0;
    F kinks[most_kinks + 2];  // where the light jumps and where the value turns, in any order
    int kink_count = 0;
    // Light: its error and its jumps.
    if constexpr (shaded) {
      const auto lit = light.error(source, inside, from, way);
      const F weight = pass * taken;
      error = max(error, weight * lit.bend);
      // A piece has one light for all of its colours: a twelfth of how much both change together. In a deep piece the front shows more of
      // its own light, too.
      error = mul_add(weight * lit.change, change * (1.0f / 12), error);
      error = mul_add(pass * lit.change, min(one, deep), error);
      const M jumping = look & (weight * lit.jump > allowed);
      if (any(jumping)) kink_count = light.jumps(lit, jumping, kinks);
    }
    if (any_turn) {
      F turn[2];
      f.turns(turn[0], turn[1]);
      for (const F& t : turn) kinks[kink_count++] = select(turning, t, 2.0f);
    }
    // Number of parts: the errors fall with its square and its fourth power.
    F count = one, per_count = one;
    if (any(look & (max(error, uneven) > allowed))) {
      const F least = max(allowed, 1e-30f);
      const F parts = max(sqrt(error / least), sqrt(sqrt(uneven / least)));
      count = max(one, min(ceil(parts), 1024.0f));
      per_count = one / count;
    }
    const F stop = set(d, plan.budget.stop_below);
    may_hide(range, shaded ? one : zero, zero);

    // Pieces, cut where the value meets the knots.
    F k = zero, v = f.a, s = zero, end, target;
    M at_kink;
    const auto aim = [&] HWY_ATTR {
      const F after = k + one;
      const M final_piece = after >= count;
      end = select(final_piece, one, after * per_count);
      at_kink = hn::MaskFromVec(zero);
      for (int i = 0; i < kink_count; ++i) {
        const M nearer = (kinks[i] > s) & (kinks[i] < end);
        at_kink = at_kink | nearer, end = select(nearer, kinks[i], end);
      }
      target = select(final_piece & !at_kink, f.last, f.at(end));
    };
    aim();
    typename MediumLanes<D>::Line& l = line_;
    for (;;) {
      // To the end of the piece, or to the knot before it: two steps along the chord, and enclosed() where these do not do.
      const M up = target >= v;
      const M ends = (up & (target <= l.hi)) | ((target >= l.lo) & !up);
      F to = end, next = target;
      const M cut = look & !ends;
      if (any(cut)) {
        const F knot = select(up, l.hi, l.lo);
        const F rise = target - v;
        const F run = (end - s) / select(rise == zero, one, rise);
        F meet = mul_add(knot - v, run, s);
        F off = zero;
        for (int i = 0; i < 2; ++i) {
          off = f.at(meet) - knot;
          meet = max(s, min(neg_mul_add(off, run, meet), end));
        }
        const M astray = cut & (abs(off) > close);
        if (any(astray)) meet = select(astray, enclosed(f, s, end, v, target, knot, close, astray), meet);
        to = select(cut, meet, to), next = select(cut, knot, next);
      }
      // Simpson's rule: optical depth of the piece, its mean value by emission and where that lies.
      const F middle = f.at(half * (s + to)), part = length * (to - s);
      const F t0 = l.sigma_t(v), tm = 4.0f * l.sigma_t(middle), t1 = l.sigma_t(next), all = t0 + tm + t1;
      const F per_all = one / max(all, 1e-37f);
      const F by_emission = mul_add(t1, next, mul_add(tm, middle, t0 * v)) * per_all;
      const F weight = mul_add(half, tm, t1) * per_all;
      const F extinctions[3] = {t0, tm * 0.25f, t1};
      segment(look, mul_add(length, s, t), part, part * (all * (1.0f / 6)), extinctions, v, next, by_emission, weight, &at_,
              [&](F at, F share, const Spread&, F& red, F& green, F& blue) HWY_ATTR {
                if constexpr (shaded) {
                  const auto on = light.at(mul_add(to - s, at, s));
                  const F flash = on.specular * share;
                  for (F* c : {&red, &green, &blue}) *c = mul_add(*c, on.diffuse, flash);
                } else if (scattered.any()) {
                  const F on = scattered_at(mul_add(length, mul_add(to - s, at, s), t));
                  for (F* c : {&red, &green, &blue}) *c = *c * on;
                }
              });
      // On to the next line, or to the next piece.
      k = select(ends & !at_kink, k + one, k);
      look = look & ((k < count) & (sum.pass >= stop));
      if (none(look)) return;
      v = next, s = to;
      if (any(cut)) {
        at_ = select(cut, at_ + select(up, set(di, 1), -1), at_);
        l = medium.line(at_);
      }
      aim();
    }
  }

  /// The light that is scattered at the places t of the rays.
  HWY_INLINE F scattered_at(F t) const {
    F q[3];
    for (int a = 0; a < 3; ++a) q[a] = mul_add(this->along[a], t, this->start[a]);
    return scattered.at(q);
  }

  /// Where a cubic that goes one way from s to end, and from a to b, has a value, to `close`, for the lanes that ask: as Pieces::meets of
  /// rays/integrate.cpp.
  static HWY_NOINLINE F enclosed(const Cubic<D>& f, F s, F end, F a, F b, F value, F close, M asking) {
    const D d;
    const F zero = set(d, 0), half = set(d, 0.5f);
    F meet = s, side = zero, at0 = a - value, at1 = b - value;
    M going = asking & !is_nan(at0 + at1);
    for (int i = 0; i < 40 && any(going); ++i) {
      const F apart = at0 - at1;
      const F next = (at0 * end - at1 * s) / select(apart == zero, 1.0f, apart);
      meet = select(going, max(s, min(next, end)), meet);
      const F here = f.at(meet) - value;
      const M inside = (meet > s) & (meet < end), wide = end - s >= 1e-6f;
      going = going & ((abs(here) > close) & (inside & wide));
      const M later = going & !((here > zero) ^ (at1 > zero)), earlier = going & !later;
      at0 = select(later & (side > zero), half * at0, select(earlier, here, at0));
      at1 = select(earlier & (side < zero), half * at1, select(later, here, at1));
      end = select(later, meet, end), s = select(earlier, meet, s);
      side = select(later, 1.0f, select(earlier, -1.0f, side));
    }
    return meet;
  }

  /// The share of the way after which the share q of its depth is passed; sigma_t at the begin, the middle and the end.
  static HWY_INLINE F way_of_depth(const F sigma_t[3], F q) {
    const D d;
    const F zero = set(d, 0), half = set(d, 0.5f), least = set(d, 1e-30f);
    const F front = sigma_t[0] + sigma_t[1], back = sigma_t[1] + sigma_t[2];
    const F x = q * (front + back);
    const M in_front = x <= front;
    // a s + (b - a) s^2 / 2 = rest / 2
    const F a = select(in_front, sigma_t[0], sigma_t[1]), b = select(in_front, sigma_t[1], sigma_t[2]);
    const F rest = select(in_front, x, x - front), sum = a + b;
    const F root = sqrt(max(zero, mul_add(a, a, rest * (b - a))));
    const F s = rest / max(a + root, least);
    return mul_add(half, min(select(sum > zero, s, 1.0f), 1.0f), select(in_front, zero, half));
  }

  /// What of a part is seen: how much nearer together than what it sends (as the variance), and how its colours change, times its share.
  struct Spread {
    F narrower, change[3];
    bool any_change;
  };
  /// Composites a segment front to back (Pieces::segment of rays/integrate.cpp): it begins at `here`, is `part` long, has the optical depth
  /// `depth`, sigma_t at its begin, middle and end, the values a and b at its ends, and `middle` as the mean by emission, at the share
  /// `weight` of its length. `line`: of the medium on which it lies; null: that of each value. `lit(at, share, spread, r, g, b)` lights the
  /// colours and the share of what is mirrored, at the share `at` of the segment.
  template <class Lit>
  HWY_INLINE void segment(M look, F here, F part, F depth, const F sigma_t[3], F a, F b, F middle, F weight, const I* line,
                          const Lit& lit) {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f), half = set(d, 0.5f);
    const M drawn = look & (depth > zero);
    if (none(drawn)) return;
    depth = only(drawn, depth);
    // Transmittance and opacity; where thin by its series: the difference would cancel.
    const F pass = exp_minus(depth);
    const F thin = depth * neg_mul_add(depth, neg_mul_add(depth, 1.0f / 6, half), one);
    const F alpha = select(depth < 0.02f, thin, one - pass);
    // Emitted colour at the mean value.
    auto color = line ? medium.color(middle, *line) : medium.color(middle);
    F r = color.r * alpha, g = color.g * alpha, bl = color.b * alpha;
    // Self-occlusion: where colour or light changes along a deep segment its front hides the back.
    M deep = drawn & (depth > 0.1f);
    deep = deep & (min(depth, 6.0f) * most_hidden_ > 12.0f);
    Spread spread{one, {zero, zero, zero}, false};
    M covaries = deep;
    if constexpr (shaded) covaries = deep | (drawn & (min(depth, one) * most_covary_ > one));
    if (any(covaries)) {
      F hidden = mul_sub(half, alpha, alpha / max(depth, 0.05f)) + pass;
      const F series = depth * depth * neg_mul_add(depth, neg_mul_add(depth, 1.0f / 80, 1.0f / 24), 1.0f / 12);
      hidden = only(deep, select(depth < 0.2f, series, hidden));
      const auto front = line ? medium.color(a, *line) : medium.color(a), back = line ? medium.color(b, *line) : medium.color(b);
      r = neg_mul_add(back.r - front.r, hidden, r), g = neg_mul_add(back.g - front.g, hidden, g);
      bl = neg_mul_add(back.b - front.b, hidden, bl);
      const F per_alpha = one / max(alpha, 0.05f);
      weight = weight - only(deep, hidden * per_alpha);
      if constexpr (shaded) {
        // 12 / depth^2 - 12 exp(-depth) / alpha^2, by its series where that cancels.
        const F square = depth * depth, per = 12.0f / max(square, one);
        const F closed = neg_mul_add(12.0f * pass, per_alpha * per_alpha, per);
        const F thin_spread = neg_mul_add(square, neg_mul_add(square, 1.0f / 504, 0.05f), one);
        // What lanes get must not depend on their neighbours.
        spread.narrower = select(covaries, select(depth < one, thin_spread, closed), one);
        const F rise[3] = {back.r - front.r, back.g - front.g, back.b - front.b};
        for (int c = 0; c < 3; ++c) spread.change[c] = only(covaries, alpha * rise[c]);
        spread.any_change = true;
      }
    }
    // Of what is as good as opaque its front alone is seen, a mean free path into it, however its colours go on.
    const M solid = deep & (depth > 16.0f);
    if (any(solid)) {
      const F sight = way_of_depth(sigma_t, one / max(depth, one)), seen = mul_add(sight, b - a, a);
      const auto front = line ? medium.color(seen, *line) : medium.color(seen);
      r = select(solid, front.r * alpha, r), g = select(solid, front.g * alpha, g), bl = select(solid, front.b * alpha, bl);
      weight = select(solid, sight, weight);
    }
    // Light on it, and front-to-back compositing.
    const F before = only(drawn, sum.pass);
    lit(weight, alpha, spread, r, g, bl);
    // Lanes that draw nothing may have been lit beside a hole.
    if constexpr (shaded) r = only(drawn, r), g = only(drawn, g), bl = only(drawn, bl);
    sum.r = mul_add(before, r, sum.r), sum.g = mul_add(before, g, sum.g), sum.b = mul_add(before, bl, sum.b);
    const F after = sum.pass * pass;
    // Where half of the light is gone.
    const M halved = drawn & ((after < half) & (sum.half_at < zero));
    if (any(halved)) {
      // ln(2 pass) = 2 atanh z
      const F z = (sum.pass - half) / (sum.pass + half), z2 = z * z;
      const F log = (z + z) * mul_add(z2, mul_add(z2, mul_add(z2, 1.0f / 7, 0.2f), 1.0f / 3), one);
      const F share = way_of_depth(sigma_t, max(zero, min(log / max(depth, 1e-30f), one)));
      sum.half_at = select(halved, mul_add(part, share, here), sum.half_at);
    }
    sum.pass = select(drawn, after, sum.pass);
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
