// SPDX-License-Identifier: Apache-2.0
// Cells that the lanes of a packet cross where opacity hangs on the gradient, too: sampled, in parts that are halved until they agree with
// their own halves (an estimate, no bound).
#if defined(SG_PACKET_DETAIL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_DETAIL_INL_H
#undef SG_PACKET_DETAIL_INL_H
#else
#define SG_PACKET_DETAIL_INL_H
#endif

#include "render/volume/engines/packets/detail_table.h"
#include "render/volume/engines/packets/packet_cells_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// A DetailTable, one value per lane.
template <class D>
class DetailLanes {
  using F = hn::Vec<D>;
  using M = hn::Mask<D>;

 public:
  HWY_INLINE explicit DetailLanes(const DetailTable& table) : table_(table) {}

  HWY_INLINE F tau(F value, F gradient) const {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), most = hn::Set(d, table_.most_tau);
    const F opacity = hn::Mul(at(table_.opacity, value), at(table_.factor, gradient));
    const M whole = hn::Ge(opacity, one);
    const F below = hn::Max(zero, hn::IfThenElseZero(hn::Not(whole), opacity));
    return hn::IfThenElse(whole, most,
                          hn::Min(most, hn::Mul(shading::HWY_NAMESPACE::minus_log_of_rest(below), hn::Set(d, table_.per_unit))));
  }
  /// May values from lo to hi draw something?
  HWY_INLINE M draw(F lo, F hi) const {
    const D d;
    M any = hn::MaskFromVec(hn::Zero(d));
    for (const DetailTable::Range& r : table_.drawn) any = hn::Or(any, hn::And(hn::Le(lo, hn::Set(d, r.hi)), hn::Ge(hi, hn::Set(d, r.lo))));
    return any;
  }
  const DetailTable& table() const { return table_; }

 private:
  static HWY_INLINE F at(const DetailTable::Curve& curve, F x) {
    const D d;
    F y = hn::Set(d, curve.y[0]);
    for (size_t i = 0; i < curve.x.size(); ++i) {
      const F from = hn::Set(d, curve.x[i]);
      y = hn::IfThenElse(hn::Ge(x, from), mul_add(hn::Set(d, curve.slope[i]), hn::Sub(x, from), hn::Set(d, curve.y[i])), y);
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

  HWY_INLINE DetailCells(const PacketPlan& p, const RayPacket& rays)
      : Rays(p, rays), medium_(*p.medium), detail_(*p.detail), lighting_(p, rays), light_(lighting_, axes) {}

  HWY_INLINE void cross(const I inside[3], F t, F leave, M look) {
    const D d;
    F from[3], way[3];
    this->way_through(inside, t, leave, from, way);
    Pair<D> rows[4];
    source.corners(source.offset(inside[0], inside[1], inside[2]), rows);
    const Cubic<D> f = along_way(rows, from, way);
    F lo, hi;
    f.hull(lo, hi);
    look = hn::And(look, hn::And(detail_.draw(lo, hi), hn::Eq(f.last, f.last)));  // no hole
    if (hn::AllFalse(d, look)) return;
    light_.find(source, inside, from, way);
    integrate(f, t, hn::Sub(leave, t), look);
  }

 private:
  /// What is at a place: extinction and, lit, its colour.
  struct Spot {
    F value, gradient, tau, color[3];
    FieldSurface<D> surface;  // of what is shaded
    HWY_INLINE void take(const Spot& o, M which) {
      for (const auto& [to, from] : {std::pair{&value, &o.value}, {&gradient, &o.gradient}, {&tau, &o.tau}})
        *to = hn::IfThenElse(which, *from, *to);
      for (int c = 0; c < 3; ++c) color[c] = hn::IfThenElse(which, o.color[c], color[c]);
      if constexpr (shaded) surface.take(o.surface, which);
    }
  };
  HWY_INLINE Spot spot(const Cubic<D>& f, F s) const {
    Spot p;
    F g[3];
    p.value = f.at(s);
    light_.gradient(s, g);
    p.gradient = hn::Sqrt(Lighting<D>::dot(g, g));
    p.tau = detail_.tau(p.value, p.gradient);
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
      const F one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f), half = hn::Set(d, 0.5f), tm = hn::Mul(hn::Set(d, 4.0f), m.tau);
      const F all = hn::Add(hn::Add(a.tau, tm), b.tau), per_all = hn::Div(one, hn::Max(all, hn::Set(d, 1e-30f)));
      depth = hn::Mul(all, hn::Mul(length, hn::Set(d, 1.0f / 6))), passes = exp_minus(depth);
      // Series where differences would cancel.
      const F square = hn::Mul(depth, depth);
      const auto thin = hn::Lt(depth, hn::Set(d, 0.3f));
      const F alpha_thin = hn::Mul(depth, neg_mul_add(depth, neg_mul_add(depth, hn::Set(d, 1.0f / 6), half), one));
      const F alpha = hn::IfThenElse(hn::Lt(depth, hn::Set(d, 0.02f)), alpha_thin, hn::Sub(one, passes));
      const F change_thin =
          hn::Mul(square, neg_mul_add(depth, neg_mul_add(depth, hn::Set(d, 1.0f / 80), hn::Set(d, 1.0f / 24)), hn::Set(d, 1.0f / 12)));
      const F bend_thin = hn::Mul(hn::Mul(square, depth), neg_mul_add(depth, hn::Set(d, 1.0f / 720), hn::Set(d, 1.0f / 360)));
      const F per_depth = hn::Div(one, hn::Max(depth, hn::Set(d, 0.1f)));
      const F i1 = mul_sub(alpha, per_depth, passes), i2 = mul_sub(hn::Add(i1, i1), per_depth, passes);
      const F of_change = hn::IfThenElse(thin, change_thin, mul_sub(half, alpha, i1));
      const F of_bend = hn::IfThenElse(thin, bend_thin, mul_add(alpha, hn::Set(d, 1.0f / 6), hn::Sub(i2, i1)));
      for (int c = 0; c < 3; ++c) {
        const F sent = mul_add(b.tau, b.color[c], mul_add(tm, m.color[c], hn::Mul(a.tau, a.color[c])));
        const F change = hn::Sub(b.color[c], a.color[c]),
                bend = mul_add(hn::Set(d, -4.0f), m.color[c], hn::Mul(two, hn::Add(a.color[c], b.color[c])));
        light[c] = mul_add(bend, of_bend, neg_mul_add(change, of_change, hn::Mul(hn::Mul(sent, per_all), alpha)));
      }
    }
  };

  HWY_INLINE void integrate(const Cubic<D>& f, F t, F length, M look) {
    const D d;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
    const F stop = hn::Set(d, plan.budget.stop_below), tolerance = hn::Set(d, float(plan.budget.tolerance));
    // Parts shorter than a cell have as much: kinks, of which there are few, would be cut down to nothing.
    const F by_cell = hn::Set(d, float(0.4 * double(plan.edge) / plan.budget.length));
    F s = zero, part = one;
    Spot a = spot(f, zero);
    for (;;) {
      const F quarter = hn::Mul(part, hn::Set(d, 0.25f)), end = hn::Min(one, hn::Add(s, part));
      const Spot p1 = spot(f, hn::Add(s, quarter)), m = spot(f, mul_add(half, part, s)),
                 p3 = spot(f, mul_add(hn::Set(d, 3.0f), quarter, s)), b = spot(f, end);
      const F whole = hn::Mul(length, part), half_length = hn::Mul(half, whole);
      const Part once(whole, a, m, b), front(half_length, a, p1, m), back(half_length, m, p3, b);
      const F passes = hn::Mul(front.passes, back.passes);
      F light[3], error = hn::Abs(hn::Sub(once.passes, passes));
      for (int c = 0; c < 3; ++c) {
        light[c] = mul_add(front.passes, back.light[c], front.light[c]);
        error = hn::Max(error, hn::Abs(hn::Sub(once.light[c], light[c])));
      }
      // Halves are wrong by half of what they differ by at most where there is one kink; with several both may be wrong alike, so what the
      // trapezoid rule differs by counts, too.
      const F taken_here = hn::Sub(one, passes), depth = hn::Add(front.depth, back.depth);
      const F per_depth = hn::Div(taken_here, hn::Max(depth, hn::Set(d, 1e-6f)));
      F bend = bend_of(a.tau, p1.tau, m.tau, p3.tau, b.tau);
      for (int c = 0; c < 3; ++c)
        bend = hn::Max(bend, bend_of(hn::Mul(a.tau, a.color[c]), hn::Mul(p1.tau, p1.color[c]), hn::Mul(m.tau, m.color[c]),
                                     hn::Mul(p3.tau, p3.color[c]), hn::Mul(b.tau, b.color[c])));
      error = hn::Max(hn::Mul(half, error), hn::Mul(hn::Set(d, 1.0f / 24), hn::Mul(hn::Mul(bend, whole), per_depth)));
      error = hn::Mul(sum.pass, error);
      const F taken = hn::Mul(sum.pass, taken_here);
      const F allowed = hn::Mul(tolerance, mul_add(hn::Set(d, 0.4f), taken, by_cell));
      const DetailTable& table = detail_.table();
      const AxisSamples values{{&a.value, &p1.value, &m.value, &p3.value, &b.value}, table.narrow, table.opacity, table.edges};
      const AxisSamples gradients{
          {&a.gradient, &p1.gradient, &m.gradient, &p3.gradient, &b.gradient}, table.narrow_second, table.factor, table.second_edges};
      F lo, hi;
      values.reach(lo, hi);
      const F faint = hn::Div(hn::Set(d, overlooked_depth / table.per_unit), hn::Max(whole, hn::Set(d, 1e-30f)));
      M missed = hn::And(detail_.draw(lo, hi), hn::Or(hn::Or(values.overlook(faint), gradients.overlook(faint)),
                                                      hn::And(values.cross_edge(), gradients.cross_edge())));
      if constexpr (shaded) {
        // A surface seen from so far aside may turn over and back between two places.
        const M turning = hn::Or(hn::Or(grazing(a.surface, p1.surface), grazing(p1.surface, m.surface)),
                                 hn::Or(grazing(m.surface, p3.surface), grazing(p3.surface, b.surface)));
        missed = hn::Or(missed, hn::And(turning, hn::And(hn::Gt(taken, tolerance), hn::Gt(part, hn::Set(d, least_turning)))));
      }
      const M fine = hn::AndNot(missed, hn::Le(error, allowed));
      const M done = hn::And(look, hn::Or(fine, hn::Le(part, hn::Set(d, least_part))));
      if (!hn::AllFalse(d, done)) {
        add(done, light, passes, mul_add(length, s, t), whole);
        s = hn::IfThenElse(done, end, s);
        a.take(b, done);
        look = hn::And(look, hn::And(hn::Lt(s, one), hn::Ge(sum.pass, stop)));
        if (hn::AllFalse(d, look)) return;
      }
      part = hn::IfThenElse(done, hn::Min(hn::Add(part, part), hn::Sub(one, s)), hn::Mul(half, part));
    }
  }

  /// By how much the trapezoid rule and Simpson's differ, 24 times, where the second differences do not cancel.
  static HWY_INLINE F bend_of(F a, F b, F c, F e, F g) {
    const auto second = [](F x, F y, F z) HWY_ATTR { return hn::Abs(hn::Sub(hn::Add(x, z), hn::Add(y, y))); };
    return hn::Add(second(a, b, c), second(c, e, g));
  }

  /// overlooks() of rays/integrate.cpp, for five samples.
  struct AxisSamples {
    const F* at[5];
    float narrow;
    const DetailTable::Curve& curve;
    const std::vector<TransferFunction::Edge>& edges;

    HWY_INLINE void range(F& lo, F& hi) const {
      lo = hi = *at[4];
      for (int i = 0; i < 4; ++i) lo = hn::Min(lo, *at[i]), hi = hn::Max(hi, *at[i]);
    }
    HWY_INLINE F beyond() const {
      const D d;
      F bend = hn::Zero(d);
      for (int i = 0; i < 3; ++i) bend = hn::Max(bend, hn::Abs(hn::Sub(hn::Add(*at[i], *at[i + 2]), hn::Add(*at[i + 1], *at[i + 1]))));
      return hn::Mul(bend, hn::Set(d, 0.5f));
    }
    HWY_INLINE void reach(F& lo, F& hi) const {
      range(lo, hi);
      lo = hn::Sub(lo, beyond()), hi = hn::Add(hi, beyond());
    }
    HWY_INLINE M overlook(F opacity) const {
      const D d;
      F most = hn::Zero(d), lo, hi;
      for (int i = 0; i < 4; ++i) most = hn::Max(most, hn::Abs(hn::Sub(*at[i], *at[i + 1])));
      range(lo, hi);
      const F far = beyond(), below = hn::Sub(lo, far), above = hn::Add(hi, far);
      M missed = hn::Gt(most, hn::Set(d, narrow));
      // Only lines nearby; as far beside the samples as these lie apart.
      if (!hn::AllFalse(d, missed)) missed = shorter_line(hn::Sub(below, most), hn::Add(above, most), most);
      for (const TransferFunction::Edge& edge : edges) {
        const F e = hn::Set(d, edge.at);
        const M there = hn::Or(hn::And(hn::Gt(e, below), hn::Le(e, lo)), hn::And(hn::Ge(e, hi), hn::Lt(e, above)));
        missed = hn::Or(missed, hn::And(there, hn::Gt(hn::Mul(hn::Set(d, edge.steep), far), opacity)));
      }
      return missed;
    }
    HWY_INLINE M shorter_line(F lo, F hi, F length) const {
      const D d;
      M found = hn::MaskFromVec(hn::Zero(d));
      for (size_t i = 0; i + 1 < curve.x.size(); ++i) {
        const float begin = curve.x[i], end = curve.x[i + 1];
        if (!(end > begin)) continue;
        const M reaches = hn::And(hn::Le(hn::Set(d, begin), hi), hn::Ge(hn::Set(d, end), lo));
        found = hn::Or(found, hn::And(reaches, hn::Gt(length, hn::Set(d, end - begin))));
      }
      return found;
    }
    HWY_INLINE M cross_edge() const {
      const D d;
      F lo, hi;
      range(lo, hi);
      M found = hn::MaskFromVec(hn::Zero(d));
      for (const TransferFunction::Edge& edge : edges) {
        const F e = hn::Set(d, edge.at);
        found = hn::Or(found, hn::And(hn::Ge(e, lo), hn::Le(e, hi)));
      }
      return found;
    }
  };

  HWY_INLINE void add(M which, const F light[3], F passes, F here, F length) {
    const D d;
    const F half = hn::Set(d, 0.5f), before = hn::IfThenElseZero(which, sum.pass);
    F* to[3] = {&sum.r, &sum.g, &sum.b};
    for (int c = 0; c < 3; ++c) *to[c] = mul_add(before, hn::IfThenElseZero(which, light[c]), *to[c]);
    const F after = hn::Mul(sum.pass, passes);
    const M halved = hn::And(which, hn::And(hn::Lt(after, half), hn::Lt(sum.half_at, hn::Zero(d))));
    const F share = hn::Div(hn::Sub(sum.pass, half), hn::Max(hn::Sub(sum.pass, after), hn::Set(d, 1e-30f)));
    sum.half_at = hn::IfThenElse(halved, mul_add(length, hn::Max(hn::Zero(d), share), here), sum.half_at);
    sum.pass = hn::IfThenElse(which, after, sum.pass);
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
