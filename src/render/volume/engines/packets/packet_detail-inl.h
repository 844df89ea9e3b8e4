// SPDX-License-Identifier: Apache-2.0
// Cells that the lanes of a packet cross where opacity depends on the gradient, too: sampled, in parts that are halved until they agree
// with their own halves (an estimate, no bound).
#if defined(SG_PACKET_DETAIL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_DETAIL_INL_H
#undef SG_PACKET_DETAIL_INL_H
#else
#define SG_PACKET_DETAIL_INL_H
#endif

#include "render/volume/engines/packets/detail_table.h"
#include "render/volume/engines/packets/packet_cells-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// A DetailTable, one value per lane.
template <class D>
class DetailLanes {
  using F = Float<D>;
  using M = Mask<D>;

 public:
  HWY_INLINE explicit DetailLanes(const DetailTable& table) : table_(table) {}

  /// The extinction coefficient.
  HWY_INLINE F sigma_t(F value, F gradient) const {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f), most = set(d, table_.most_sigma_t);
    const F opacity = at(table_.opacity, value) * at(table_.factor, gradient);
    const M whole = opacity >= one;
    const F below = max(zero, only(!whole, opacity));
    return select(whole, most, min(most, shading::HWY_NAMESPACE::minus_log_of_rest(below) * table_.per_unit));
  }
  /// May values from lo to hi draw something?
  HWY_INLINE M draw(F lo, F hi) const {
    const D d;
    M draws = hn::MaskFromVec(set(d, 0));
    for (const DetailTable::Range& r : table_.drawn) draws = draws | ((lo <= r.hi) & (hi >= r.lo));
    return draws;
  }
  const DetailTable& table() const { return table_; }

 private:
  static HWY_INLINE F at(const DetailTable::Curve& curve, F x) {
    const D d;
    F y = set(d, curve.y[0]);
    for (size_t i = 0; i < curve.x.size(); ++i) {
      const F from = set(d, curve.x[i]);
      y = select(x >= from, mul_add(curve.slope[i], x - from, curve.y[i]), y);
    }
    return y;
  }

  const DetailTable& table_;
};

template <class D, class T, bool shaded, class Axes>
class DetailCells : public RayLanes<D, T, Axes> {
  using Rays = RayLanes<D, T, Axes>;
  using typename Rays::F, typename Rays::I, typename Rays::M;

 public:
  using Rays::plan, Rays::source, Rays::axes, Rays::sum;

  HWY_INLINE DetailCells(const DetailPlan& p, const RayPacket& rays)
      : Rays(p, rays), medium_(*p.medium), detail_(*p.table), lighting_(p.volume, p.light, rays), light_(lighting_, axes) {}

  /// One cell per lane, from t to `leave`.
  HWY_INLINE void cross(const I inside[3], F t, F leave, M look) {
    F from[3], way[3];
    this->way_through(inside, t, leave, from, way);
    Pair<D> rows[4];
    source.corners(source.offset(inside[0], inside[1], inside[2]), rows);
    const Cubic<D> f = along_way(rows, from, way);
    F lo, hi;
    f.hull(lo, hi);
    look = look & (detail_.draw(lo, hi) & (f.last == f.last));  // no hole
    if (none(look)) return;
    light_.find(source, inside, from, way);
    integrate(f, t, leave - t, look);
  }

 private:
  /// What is at a place: extinction and, lit, its colour.
  struct Spot {
    F value, gradient, sigma_t, color[3];
    FieldSurface<D> surface;  // of what is shaded
    HWY_INLINE void take(const Spot& o, M which) {
      for (const auto& [to, from] : {std::pair{&value, &o.value}, {&gradient, &o.gradient}, {&sigma_t, &o.sigma_t}})
        *to = select(which, *from, *to);
      for (int c = 0; c < 3; ++c) color[c] = select(which, o.color[c], color[c]);
      if constexpr (shaded) surface.take(o.surface, which);
    }
  };
  HWY_NOINLINE Spot spot(const Cubic<D>& f, F s) const {
    Spot p;
    F g[3];
    p.value = f.at(s);
    light_.gradient(s, g);
    p.gradient = sqrt(Lighting<D>::dot(g, g));
    p.sigma_t = detail_.sigma_t(p.value, p.gradient);
    const auto color = medium_.color(p.value);
    p.color[0] = color.r, p.color[1] = color.g, p.color[2] = color.b;
    if constexpr (shaded) {
      p.surface = lighting_.surface(g);
      const LitLanes<D> lit = lighting_.on(p.surface);
      for (F& c : p.color) c = mul_add(c, lit.diffuse, lit.specular);
    }
    return p;
  }

  /// A part from the places at its begin, middle and end: its optical depth D by Simpson's rule; its light from the mean colour by emission
  /// less what the front hides of how colours change, exact for an even extinction and parabolas of colour. With
  /// I1 = integral of D x exp(-D x) over 0..1 and I2 that of D x^2 exp(-D x): (alpha/2 - I1) of the change, (I2 - I1 + alpha/6) of the
  /// bend.
  struct Part {
    F depth, passes, light[3];
    HWY_INLINE Part(F length, const Spot& a, const Spot& m, const Spot& b) {
      const D d;
      const F one = set(d, 1.0f), two = set(d, 2.0f), half = set(d, 0.5f), tm = 4.0f * m.sigma_t;
      const F all = a.sigma_t + tm + b.sigma_t, per_all = one / max(all, 1e-30f);
      depth = all * (length * (1.0f / 6)), passes = exp_minus(depth);
      // Series where differences would cancel.
      const F square = depth * depth;
      const auto thin = depth < 0.3f;
      const F alpha_thin = depth * neg_mul_add(depth, neg_mul_add(depth, 1.0f / 6, half), one);
      const F alpha = select(depth < 0.02f, alpha_thin, one - passes);
      const F change_thin = square * neg_mul_add(depth, neg_mul_add(depth, 1.0f / 80, 1.0f / 24), 1.0f / 12);
      const F bend_thin = square * depth * neg_mul_add(depth, 1.0f / 720, 1.0f / 360);
      const F per_depth = one / max(depth, 0.1f);
      const F i1 = mul_sub(alpha, per_depth, passes), i2 = mul_sub(i1 + i1, per_depth, passes);
      const F of_change = select(thin, change_thin, mul_sub(half, alpha, i1));
      const F of_bend = select(thin, bend_thin, mul_add(alpha, 1.0f / 6, i2 - i1));
      for (int c = 0; c < 3; ++c) {
        const F sent = mul_add(b.sigma_t, b.color[c], mul_add(tm, m.color[c], a.sigma_t * a.color[c]));
        const F change = b.color[c] - a.color[c], bend = mul_add(-4.0f, m.color[c], two * (a.color[c] + b.color[c]));
        light[c] = mul_add(bend, of_bend, neg_mul_add(change, of_change, sent * per_all * alpha));
      }
    }
  };

  HWY_NOINLINE void integrate(const Cubic<D>& f, F t, F length, M look) {
    const D d;
    const F zero = set(d, 0), one = set(d, 1.0f), half = set(d, 0.5f);
    const F stop = set(d, plan.budget.stop_below), tolerance = set(d, float(plan.budget.tolerance));
    // Parts shorter than a cell have as much: kinks, of which there are few, would be cut down to nothing.
    const F by_cell = set(d, float(0.4 * double(float(plan.volume.edge)) / plan.budget.length));
    F s = zero, part = one;
    Spot a = spot(f, zero);
    for (;;) {
      // Five places of the part: the integral over all of it, and over both halves.
      const F quarter = part * 0.25f, end = min(one, s + part);
      const Spot p1 = spot(f, s + quarter), m = spot(f, mul_add(half, part, s)), p3 = spot(f, mul_add(3.0f, quarter, s)), b = spot(f, end);
      const F whole = length * part, half_length = half * whole;
      const Part once(whole, a, m, b), front(half_length, a, p1, m), back(half_length, m, p3, b);
      const F passes = front.passes * back.passes;
      F light[3], error = abs(once.passes - passes);
      for (int c = 0; c < 3; ++c) {
        light[c] = mul_add(front.passes, back.light[c], front.light[c]);
        error = max(error, abs(once.light[c] - light[c]));
      }
      // Halves are wrong by half of what they differ by at most where there is one kink; with several both may be wrong alike, so what the
      // trapezoid rule differs by counts, too.
      const F taken_here = one - passes, depth = front.depth + back.depth;
      const F per_depth = taken_here / max(depth, 1e-6f);
      F bend = bend_of(a.sigma_t, p1.sigma_t, m.sigma_t, p3.sigma_t, b.sigma_t);
      for (int c = 0; c < 3; ++c)
        bend = max(bend, bend_of(a.sigma_t * a.color[c], p1.sigma_t * p1.color[c], m.sigma_t * m.color[c], p3.sigma_t * p3.color[c],
                                 b.sigma_t * b.color[c]));
      error = max(half * error, 1.0f / 24 * (bend * whole * per_depth));
      error = sum.pass * error;
      const F taken = sum.pass * taken_here;
      const F allowed = tolerance * mul_add(0.4f, taken, by_cell);
      // Do the curves have anything between the places that these do not show?
      const DetailTable& table = detail_.table();
      const AxisSamples values{{&a.value, &p1.value, &m.value, &p3.value, &b.value}, table.narrow, table.opacity, table.edges};
      const AxisSamples gradients{
          {&a.gradient, &p1.gradient, &m.gradient, &p3.gradient, &b.gradient}, table.narrow_second, table.factor, table.second_edges};
      F lo, hi;
      values.reach(lo, hi);
      const F faint = overlooked_depth / table.per_unit / max(whole, 1e-30f);
      M missed =
          detail_.draw(lo, hi) & (values.overlook(faint) | gradients.overlook(faint) | (values.cross_edge() & gradients.cross_edge()));
      if constexpr (shaded) {
        // A surface seen from so far aside may turn over and back between two places.
        const M turning = grazing(a.surface, p1.surface) | grazing(p1.surface, m.surface) |
                          (grazing(m.surface, p3.surface) | grazing(p3.surface, b.surface));
        missed = missed | (turning & ((taken > tolerance) & (part > least_turning)));
      }
      // Parts that are good enough, or short enough, are composited; the others are halved.
      const M fine = (error <= allowed) & !missed;
      const M done = look & (fine | (part <= least_part));
      if (any(done)) {
        add(done, light, passes, mul_add(length, s, t), whole);
        s = select(done, end, s);
        a.take(b, done);
        look = look & ((s < one) & (sum.pass >= stop));
        if (none(look)) return;
      }
      part = select(done, min(part + part, one - s), half * part);
    }
  }

  /// By how much the trapezoid rule and Simpson's differ, 24 times, where the second differences do not cancel.
  static HWY_INLINE F bend_of(F a, F b, F c, F e, F g) {
    const auto second = [](F x, F y, F z) HWY_ATTR { return abs(x + z - (y + y)); };
    return second(a, b, c) + second(c, e, g);
  }

  /// overlooks() of rays/integrate.cpp, for five samples.
  struct AxisSamples {
    const F* at[5];
    float narrow;
    const DetailTable::Curve& curve;
    const std::vector<TransferFunction::Edge>& edges;

    HWY_INLINE void range(F& lo, F& hi) const {
      lo = hi = *at[4];
      for (int i = 0; i < 4; ++i) lo = min(lo, *at[i]), hi = max(hi, *at[i]);
    }
    HWY_INLINE F beyond() const {
      const D d;
      F bend = set(d, 0);
      for (int i = 0; i < 3; ++i) bend = max(bend, abs(*at[i] + *at[i + 2] - (*at[i + 1] + *at[i + 1])));
      return bend * 0.5f;
    }
    HWY_INLINE void reach(F& lo, F& hi) const {
      range(lo, hi);
      lo = lo - beyond(), hi = hi + beyond();
    }
    HWY_INLINE M overlook(F opacity) const {
      const D d;
      F most = set(d, 0), lo, hi;
      for (int i = 0; i < 4; ++i) most = max(most, abs(*at[i] - *at[i + 1]));
      range(lo, hi);
      const F far = beyond(), below = lo - far, above = hi + far;
      M missed = most > narrow;
      // Only lines nearby; as far beside the samples as these lie apart.
      if (any(missed)) missed = shorter_line(below - most, above + most, most);
      for (const TransferFunction::Edge& edge : edges) {
        const F e = set(d, edge.at);
        const M there = ((e > below) & (e <= lo)) | ((e >= hi) & (e < above));
        missed = missed | (there & (edge.steep * far > opacity));
      }
      return missed;
    }
    HWY_INLINE M shorter_line(F lo, F hi, F length) const {
      const D d;
      M found = hn::MaskFromVec(set(d, 0));
      for (size_t i = 0; i + 1 < curve.x.size(); ++i) {
        const float begin = curve.x[i], end = curve.x[i + 1];
        if (!(end > begin)) continue;
        const M reaches = (begin <= hi) & (end >= lo);
        found = found | (reaches & (length > end - begin));
      }
      return found;
    }
    HWY_INLINE M cross_edge() const {
      const D d;
      F lo, hi;
      range(lo, hi);
      M found = hn::MaskFromVec(set(d, 0));
      for (const TransferFunction::Edge& edge : edges) {
        const F e = set(d, edge.at);
        found = found | ((e >= lo) & (e <= hi));
      }
      return found;
    }
  };

  /// Composites a part front to back.
  HWY_INLINE void add(M which, const F light[3], F passes, F here, F length) {
    const D d;
    const F half = set(d, 0.5f), before = only(which, sum.pass);
    F* to[3] = {&sum.r, &sum.g, &sum.b};
    for (int c = 0; c < 3; ++c) *to[c] = mul_add(before, only(which, light[c]), *to[c]);
    const F after = sum.pass * passes;
    const M halved = which & ((after < half) & (sum.half_at < 0));
    const F share = (sum.pass - half) / max(sum.pass - after, 1e-30f);
    sum.half_at = select(halved, mul_add(length, max(0, share), here), sum.half_at);
    sum.pass = select(which, after, sum.pass);
  }

  static constexpr float least_part = 1.0f / 256, least_turning = 1.0f / 16;  // of a cell

  const MediumLanes<D> medium_;
  const DetailLanes<D> detail_;
  const Lighting<D> lighting_;
  CellLight<D, T, Axes> light_;
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
