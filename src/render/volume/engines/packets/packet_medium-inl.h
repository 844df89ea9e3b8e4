// SPDX-License-Identifier: Apache-2.0
// The medium for packets of rays: one value per lane.
#if defined(SG_PACKET_MEDIUM_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_MEDIUM_INL_H
#undef SG_PACKET_MEDIUM_INL_H
#else
#define SG_PACKET_MEDIUM_INL_H
#endif

#include "render/volume/engines/packets/packets-inl.h"
#include "render/volume/medium/medium.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// The medium, ready for gathers.
template <class D>
struct MediumLanes {
  using F = Float<D>;
  using I = Int<D>;
  const Medium& medium;
  const Medium::Columns& columns;

  /// A line of the medium: sigma_t is a cubic of the value from lo to hi, with these coefficients at `origin`.
  struct Line {
    F lo, hi, origin, at, slope, curve, twist;
    HWY_INLINE F sigma_t(F v) const {
      const F x = v - origin;
      return max(0, mul_add(x, mul_add(x, mul_add(x, twist, curve), slope), at));
    }
    HWY_INLINE F slope_at(F v) const {
      const F x = v - origin;
      return abs(mul_add(x, mul_add(x, 3.0f * twist, curve + curve), slope));
    }
    HWY_INLINE Mask<D> dark() const {
      const F zero = set(D(), 0);
      return (at == zero) & (slope == zero) & ((curve == zero) & (twist == zero));
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
  /// By its number.
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
    l.lo = select(i == 0, -HUGE_VALF, l.origin);
    return l;
  }
  /// The number of the line on which a value lies: that of its slice of values, and on over those that end before it.
  HWY_INLINE I line_of(F v) const {
    const D d;
    const IntTag<D> di;
    v = min(v, 3e38f);  // the last line ends at infinity
    F at = (v - medium.slice_lo()) * medium.per_slice();
    at = only(at >= 0, min(at, float(Medium::slices)));
    I i = gather_words(d, medium.first_lines(), shift_left<1>(to_int(d, at)), loads) & 0xFFFF;
    for (;;) {
      const auto beyond =
          (few ? hn::TableLookupLanes(few_columns[1], hn::IndicesFromVec(d, i)) : hn::GatherIndex(d, columns.hi.data(), i)) <= v;
      if (none(beyond)) return i;
      i = i - hn::VecFromMask(di, rebind(di, beyond));
    }
  }
  /// The largest of a column over the lines a .. b, from the table of powers of two.
  HWY_INLINE F most(const std::vector<float>& table, I a, I b) const {
    const D d;
    const IntTag<D> di;
    const I count = b - a + 1;
    const I k = shift_right<23>(bit_cast(di, convert(d, count))) - 127;
    const I row = k * int(columns.hi.size());
    const I width = to_int(d, bit_cast(d, shift_left<23>(k + 127)));
    return max(hn::GatherIndex(d, table.data(), row + a), hn::GatherIndex(d, table.data(), row + (b + 1 - width)));
  }
  struct Color {
    F r, g, b;
  };
  HWY_INLINE Color color(F v) const {
    if (medium.pieced()) return color_on(v, line_of(v));
    const D d;
    F at = mul_add(v - medium.first_node(), medium.per_node(), 0.5f);
    at = only(at >= 0, min(at, float(Medium::nodes)));
    return color_of_node(to_int(d, at));
  }
  /// On a line, its ends included: at a knot colours may jump.
  HWY_INLINE Color color(F v, I line) const { return medium.pieced() ? color_on(v, line) : color(v); }
  /// Medium::leaning.
  HWY_INLINE F leaning(F slope, F range, F bend, F twist) const {
    const D d;
    const F one = set(d, 1.0f), per_opacity = min(slope * medium.unit(), 1e30f);
    const auto turned = [&](F by) HWY_ATTR { return min(per_opacity * by, one); };
    const F y = turned(range), u = turned(bend);
    return medium.per_unit() * mul_add(u, mul_add(0.5f, u, y * y), turned(twist) * y);
  }
  /// Do abrupt knots lie between two lines?
  HWY_INLINE Mask<D> abrupt(I first, I last) const {
    const D d;
    const auto* before = reinterpret_cast<const float*>(medium.abrupt_before());
    const IntTag<D> di;
    return rebind(d, bit_cast(di, hn::GatherIndex(d, before, first)) != bit_cast(di, hn::GatherIndex(d, before, last)));
  }

 private:
  HWY_NOINLINE Color color_on(F v, I line) const {
    const D d;
    const auto [lo_per, first_count] = gather_quad(d, reinterpret_cast<const float*>(medium.pieces()), shift_left<2>(line), loads);
    F at = mul_add(v - lo_per.a, lo_per.b, 0.5f);
    at = only(at >= 0, min(at, first_count.b));
    return color_of_node(to_int(d, at) + to_int(d, first_count.a));
  }
  HWY_INLINE Color color_of_node(I node) const {
    const D d;
    const IntTag<D> di;
    const Pair<D> words = gather_pair(d, reinterpret_cast<const float*>(medium.colors()), shift_left<1>(node), loads);
    const I rg = bit_cast(di, words.a), b = bit_cast(di, words.b);
    const F per = set(d, 1.0f / 65535);
    const I low = set(di, 0xFFFF);
    const hn::RebindToUnsigned<IntTag<D>> du;
    const I g = bit_cast(di, shift_right<16>(bit_cast(du, rg)));
    return {convert(d, rg & low) * per, convert(d, g) * per, convert(d, b & low) * per};
  }
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
