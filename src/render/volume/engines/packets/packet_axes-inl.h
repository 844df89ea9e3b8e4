// SPDX-License-Identifier: Apache-2.0
// The axes of a lattice along which packets go from cell to cell: samples are one apart, or lie where a table says.
#if defined(SG_PACKET_AXES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_AXES_INL_H
#undef SG_PACKET_AXES_INL_H
#else
#define SG_PACKET_AXES_INL_H
#endif

#include "render/volume/engines/packets/packet_around-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// q = u.
template <class D>
class EvenAxes {
  using F = Float<D>;
  using I = Int<D>;

 public:
  template <class T>
  HWY_INLINE EvenAxes(const IntegralPlan&, const Source<D, T>& source) {
    for (int a = 0; a < 3; ++a) last_cell_[a] = source.last_cell[a];
  }

  /// The cell at a place of an axis; -1 and last + 1 are the halves beyond the outermost samples.
  HWY_INLINE I cell_at(int a, F q) const {
    const D d;
    return min(max(to_int(d, floor(q)), -1), last_cell_[a] + 1);
  }
  /// Where sample `number` lies, or what is beyond all of them.
  HWY_INLINE F sample(int, I number) const { return convert(D(), number); }
  /// The share of the edge of cell `inside` at a place start + along * t, for any t.
  struct Shares {
    F base;
    HWY_INLINE F at(F along, F t) const { return mul_add(along, t, base); }
  };
  HWY_INLINE Shares shares(int, I inside, F start) const { return {start - convert(D(), inside)}; }

  /// Derivatives in q in one cell of each lane.
  template <class T>
  class Slopes {
   public:
    HWY_INLINE void find(const EvenAxes&, const Around<D, T>& around, const I[3]) { changes_.find(around); }
    /// The same; where a neighbour is no number, one-sided.
    HWY_INLINE void find_beside_holes(const EvenAxes&, const Around<D, T>& around, const I[3]) { changes_.find_beside_holes(around); }
    /// Along axis a, on the way from + s * way.
    HWY_INLINE Cubic<D> along(int a, const F from[3], const F way[3]) const { return changes_.on(a, from, way).times(set(D(), 0.5f)); }

   private:
    CornerChanges<D, T> changes_;
  };

 private:
  I last_cell_[3];
};

/// UnevenAxes of rectilinear grids.
template <class D>
class UnevenLanes {
  using F = Float<D>;
  using I = Int<D>;

 public:
  template <class T>
  HWY_INLINE UnevenLanes(const UnevenPlan& plan, const Source<D, T>& source) : axes_(*plan.axes), loads_(source.loads) {
    for (int a = 0; a < 3; ++a) last_cell_[a] = source.last_cell[a];
  }

  HWY_INLINE I cell_at(int a, F q) const {
    const D d;
    const IntTag<D> di;
    const I zero = set(di, 0), one = set(di, 1);
    const F slice = (q - axes_.first[a]) * axes_.slices_per_q[a];
    const F last_slice = set(d, float(axes_.slices[a].size() - 1));
    const I in_slice = to_int(d, max(0, min(slice, last_slice)));
    I cell = gather_words(d, axes_.slices[a].data(), shift_left<2>(in_slice), loads_);
    // The slice may begin before it by rounding, and end some cells on.
    const auto before = [&](I c) HWY_ATTR { return rebind(di, q < sample(a, c)); };
    cell = select(before(cell), max(cell - one, zero), cell);
    while (true) {
      const I next = cell + one;
      const auto on = !(before(next) | (cell == last_cell_[a]));
      if (none(on)) break;
      cell = select(on, next, cell);
    }
    const I end = last_cell_[a] + one;
    cell = select(before(zero), -1, cell);
    return select(q > sample(a, end), end, cell);
  }
  HWY_INLINE F sample(int a, I number) const {
    const D d;
    const IntTag<D> di;
    const I zero = set(di, 0), last = last_cell_[a] + 1;
    const I inside = max(zero, min(number, last));
    const F at = bit_cast(d, gather_words(d, axes_.cells[a].data(), shift_left<3>(inside), loads_));
    const F below = set(d, -HUGE_VALF), above = set(d, HUGE_VALF);
    return select(number < zero, below, select(number > last, above, at));
  }
  struct Shares {
    F base, per_width;
    HWY_INLINE F at(F along, F t) const { return mul_add(along, t, base) * per_width; }
  };
  HWY_INLINE Shares shares(int a, I inside, F start) const {
    const Pair<D> cell = gather_pair(D(), reinterpret_cast<const float*>(axes_.cells[a].data()), shift_left<1>(inside), loads_);
    return {start - cell.a, cell.b};
  }

  template <class T>
  class Slopes {
   public:
    HWY_INLINE void find(const UnevenLanes& lanes, const Around<D, T>& around, const I cell[3]) {
      corners(lanes, around, cell,
              [](const Pair<D>& w, F before, F own, F after) HWY_ATTR { return mul_add(w.b, after - own, w.a * (own - before)); });
    }
    HWY_NOINLINE void find_beside_holes(const UnevenLanes& lanes, const Around<D, T>& around, const I cell[3]) {
      corners(lanes, around, cell, [](const Pair<D>& w, F before, F own, F after) HWY_ATTR {
        const F back = own - before, on = after - own,
                whole = sqrt(w.a * w.b);  // 1 / distance of the neighbours
        F slope = mul_add(w.b, on, w.a * back);
        slope = select(is_nan(back), on * (w.b + whole), slope);
        slope = select(is_nan(on), back * (w.a + whole), slope);
        return only(!is_nan(slope), slope);
      });
    }
    HWY_INLINE Cubic<D> along(int a, const F from[3], const F way[3]) const { return Around<D, T>::trilinear(slope_[a], from, way); }

   private:
    template <class Slope>
    HWY_INLINE void corners(const UnevenLanes& lanes, const Around<D, T>& around, const I cell[3], const Slope& slope) {
      Quad<D> rows[4];
      around.rows(rows);
      corners_along<0>(lanes, around, rows, cell[0], slope), corners_along<1>(lanes, around, rows, cell[1], slope);
      corners_along<2>(lanes, around, rows, cell[2], slope);
    }
    template <int axis, class Slope>
    HWY_INLINE void corners_along(const UnevenLanes& lanes, const Around<D, T>& around, const Quad<D> rows[4], I cell, const Slope& slope) {
      const Quad<D> w = lanes.weights(axis, cell);
      around.template neighbours<axis>(rows, [&](int corner, F before, F own, F after) HWY_ATTR {
        slope_[axis][corner] = slope(corner >> axis & 1 ? w.high : w.low, before, own, after);
      });
      around.edge(axis).mend_corners(slope_[axis], axis, 1);
    }

    F slope_[3][8];  // at the corners
  };

 private:
  /// DerivativeWeights of both samples of a cell.
  HWY_INLINE Quad<D> weights(int a, I cell) const {
    return gather_quad(D(), reinterpret_cast<const float*>(axes_.weights[a].data()), shift_left<1>(cell), loads_);
  }

  const UnevenAxes& axes_;
  I last_cell_[3];
  const bool loads_;
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
