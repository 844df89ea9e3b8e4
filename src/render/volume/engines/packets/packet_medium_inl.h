// SPDX-License-Identifier: Apache-2.0
// The medium for packets of rays: one value per lane.
#if defined(SG_PACKET_MEDIUM_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_MEDIUM_INL_H
#undef SG_PACKET_MEDIUM_INL_H
#else
#define SG_PACKET_MEDIUM_INL_H
#endif

#include "render/volume/engines/packets/packets_inl.h"
#include "render/volume/medium/medium.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// exp_minus of rays/integrate.cpp.
template <class D>
HWY_INLINE hn::Vec<D> exp_minus_of(D d, hn::Vec<D> x) {
  const IntTag<D> di;
  const auto deep = hn::Ge(x, hn::Set(d, 87.0f));
  x = hn::Min(x, hn::Set(d, 87.0f));
  const auto k = to_int(d, mul_add(x, hn::Set(d, 1.44269504f), hn::Set(d, 0.5f)));
  const auto kf = hn::ConvertTo(d, k);
  const auto r = hn::Neg(neg_mul_add(kf, hn::Set(d, 1.42860677e-6f), neg_mul_add(kf, hn::Set(d, 0.693145752f), x)));
  auto sum = hn::Set(d, 1.0f / 5040);
  for (const float c : {1.0f / 720, 1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) sum = mul_add(sum, r, hn::Set(d, c));
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
      return hn::Max(hn::Zero(D()), mul_add(x, mul_add(x, mul_add(x, twist, curve), slope), at));
    }
    HWY_INLINE F slope_at(F v) const {
      const F x = hn::Sub(v, origin);
      return hn::Abs(mul_add(x, mul_add(x, hn::Mul(hn::Set(D(), 3.0f), twist), hn::Add(curve, curve)), slope));
    }
    HWY_INLINE hn::Mask<D> dark() const {
      const F zero = hn::Zero(D());
      return hn::And(hn::And(hn::Eq(at, zero), hn::Eq(slope, zero)), hn::And(hn::Eq(curve, zero), hn::Eq(twist, zero)));
    }
  };
  /// As many lines as there are lanes fit a vector: then no gather is needed.
  bool few;
  bool loads;  ///< of gathers.h
  F few_columns[6];
  HWY_INLINE explicit MediumLanes(const Medium& m)
      : medium(m), columns(m.columns()), few(m.lines().size() <= size_t(lanes_of<D>)), loads(loads_beat_gathers()) {
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
    I i = hn::And(gather_words(d, medium.first_lines(), hn::ShiftLeft<1>(to_int(d, at)), loads), hn::Set(di, 0xFFFF));
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
    if (medium.pieced()) return color_on(v, line_of(v));
    const D d;
    F at = mul_add(hn::Sub(v, hn::Set(d, medium.first_node())), hn::Set(d, medium.per_node()), hn::Set(d, 0.5f));
    at = hn::IfThenElseZero(hn::Ge(at, hn::Zero(d)), hn::Min(at, hn::Set(d, float(Medium::nodes))));
    return color_of_node(to_int(d, at));
  }
  /// On a line, its ends included: at a knot colours may jump.
  HWY_INLINE Color color(F v, I line) const { return medium.pieced() ? color_on(v, line) : color(v); }
  /// Medium::leaning.
  HWY_INLINE F leaning(F slope, F range, F bend, F twist) const {
    const D d;
    const F one = hn::Set(d, 1.0f), per_opacity = hn::Min(hn::Mul(slope, hn::Set(d, medium.unit())), hn::Set(d, 1e30f));
    const auto turned = [&](F by) HWY_ATTR { return hn::Min(hn::Mul(per_opacity, by), one); };
    const F y = turned(range), u = turned(bend);
    return hn::Mul(hn::Set(d, medium.per_unit()), mul_add(u, mul_add(hn::Set(d, 0.5f), u, hn::Mul(y, y)), hn::Mul(turned(twist), y)));
  }
  /// Do abrupt knots lie between two lines?
  HWY_INLINE hn::Mask<D> abrupt(I first, I last) const {
    const D d;
    const auto* before = reinterpret_cast<const float*>(medium.abrupt_before());
    const IntTag<D> di;
    return hn::RebindMask(d, hn::Ne(hn::BitCast(di, hn::GatherIndex(d, before, first)), hn::BitCast(di, hn::GatherIndex(d, before, last))));
  }

 private:
  HWY_NOINLINE Color color_on(F v, I line) const {
    const D d;
    const auto [lo_per, first_count] = gather_quad(d, reinterpret_cast<const float*>(medium.pieces()), hn::ShiftLeft<2>(line), loads);
    F at = mul_add(hn::Sub(v, lo_per.a), lo_per.b, hn::Set(d, 0.5f));
    at = hn::IfThenElseZero(hn::Ge(at, hn::Zero(d)), hn::Min(at, first_count.b));
    return color_of_node(hn::Add(to_int(d, at), to_int(d, first_count.a)));
  }
  HWY_INLINE Color color_of_node(I node) const {
    const D d;
    const IntTag<D> di;
    const Pair<D> words = gather_pair(d, reinterpret_cast<const float*>(medium.colors()), hn::ShiftLeft<1>(node), loads);
    const I rg = hn::BitCast(di, words.a), b = hn::BitCast(di, words.b);
    const F per = hn::Set(d, 1.0f / 65535);
    const I low = hn::Set(di, 0xFFFF);
    const hn::RebindToUnsigned<IntTag<D>> du;
    const I g = hn::BitCast(di, hn::ShiftRight<16>(hn::BitCast(du, rg)));
    return {hn::Mul(hn::ConvertTo(d, hn::And(rg, low)), per), hn::Mul(hn::ConvertTo(d, g), per),
            hn::Mul(hn::ConvertTo(d, hn::And(b, low)), per)};
  }
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
