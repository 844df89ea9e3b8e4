// SPDX-License-Identifier: Apache-2.0
// Central differences at the corners of cells. Trilinear between the corners they are the central differences of the trilinear field.
#if defined(SG_PACKET_AROUND_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_AROUND_INL_H
#undef SG_PACKET_AROUND_INL_H
#else
#define SG_PACKET_AROUND_INL_H
#endif

#include "render/volume/engines/packets/packet_cubic-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// One axis of a cell of each lane, which may be the first or the last there.
template <class D>
struct Edge {
  using F = Float<D>;
  Mask<D> first, last;
  bool inner;  ///< no lane's is

  /// Differences over two cells (or derivatives) at both ends, of which those at the border are made good (border_slope()). `whole`: what
  /// they would be if the field went straight over the cell.
  HWY_INLINE void mend(F& lower, F& upper, F whole) const {
    const auto alone = first & last;
    const F twice = whole + whole, lo = select(alone, whole, lower), hi = select(alone, whole, upper);
    lower = select(first, twice - hi, lower), upper = select(last, twice - lo, upper);
  }
  /// The same for the corners i + 2 j + 4 k of a cell, `per_cell` being what a difference over one cell, as there is at the border, counts.
  HWY_INLINE void mend_corners(F at[8], int axis, float per_cell) const {
    if (inner) return;
    for (int c = 0; c < 8; ++c) {
      if (c >> axis & 1) continue;
      F &lower = at[c], &upper = at[c | 1 << axis];
      mend(lower, upper, per_cell * select(first, lower, upper));
    }
  }
  /// The difference over two cells around a fraction of the edge from a to b.
  HWY_INLINE F change(F before, F a, F b, F after, F fraction) const {
    const D d;
    F lower = b - before, upper = after - a;
    if (!inner) {
      const F over = b - a;
      mend(lower, upper, over + over);
    }
    return mixed(d, lower, upper, fraction);
  }
};

/// A cell of each lane with the samples one beyond it along each axis; beyond the border those are the outermost again.
template <class D, class T>
class Around {
  using F = Float<D>;
  using I = Int<D>;

 public:
  bool inner = true;  ///< no lane's cell is the first or the last of an axis

  HWY_INLINE Around(const Source<D, T>& source, const I cell[3]) : source_(source), corner_(source.offset(cell[0], cell[1], cell[2])) {
    const D d;
    for (int a = 0; a < 3; ++a) {
      const auto in_first = cell[a] == 0, in_last = cell[a] == source.last_cell[a];
      first_[a] = rebind(d, in_first), last_[a] = rebind(d, in_last);
      inner = inner && none(in_first | in_last);
    }
  }

  HWY_INLINE Edge<D> edge(int axis) const { return {first_[axis], last_[axis], inner}; }
  /// The cell's lowest sample.
  HWY_INLINE I corner() const { return corner_; }

  /// The cell's own samples: 4 rows of Source::corners. They come with those before and after them along x.
  HWY_INLINE void rows(Quad<D> rows[4]) const {
    const ptrdiff_t row = source_.to_row, layer = source_.to_layer;
    if (inner) return source_.quads(corner_, {-1, row - 1, layer - 1, layer + row - 1}, rows);
    const I before = corner_ + step(first_[0], 0, -1), after = corner_ + step(last_[0], 0, 1);
    Pair<D> low[4], own[4], high[4];
    source_.corners(before, low), source_.corners(corner_, own), source_.corners(after, high);
    for (int r = 0; r < 4; ++r) rows[r] = {{low[r].a, own[r].a}, {own[r].b, high[r].b}};
  }
  /// The rows beyond the cell along y or z: on the side before it, both along the other axis, then on the side after it.
  template <int axis>
  HWY_INLINE void beyond(Pair<D> rows[4]) const {
    const ptrdiff_t along = axis == 1 ? source_.to_row : source_.to_layer, across = axis == 1 ? source_.to_layer : source_.to_row;
    if (inner) return source_.pairs(corner_, {-along, across - along, 2 * along, 2 * along + across}, rows);
    source_.pairs(corner_ + step(first_[axis], 0, -int(along)), {0, across}, rows);
    source_.pairs(corner_ + step(last_[axis], int(along), int(2 * along)), {0, across}, rows + 2);
  }
  /// each(corner i + 2 j + 4 k, the sample before it along the axis, its own, the one after it), of what rows() told.
  template <int axis, class Each>
  HWY_INLINE void neighbours(const Quad<D> rows[4], const Each& each) const {
    if constexpr (axis == 0) {
      for (int r = 0; r < 4; ++r) {
        const auto& [low, high] = rows[r];
        each(2 * r, low.a, low.b, high.a), each(2 * r + 1, low.b, high.a, high.b);
      }
    } else {
      Pair<D> outer[4];
      beyond<axis>(outer);
      constexpr int s = axis, t = 3 - axis;  // numbers of rows from one to the next along and across
      const auto side = [&](int n) HWY_ATTR {
        const Quad<D>&own = rows[n * t], &next = rows[n * t + s];
        const int lower = 2 * (n * t), upper = lower + 2 * s;
        each(lower, outer[n].a, own.low.b, next.low.b), each(lower + 1, outer[n].b, own.high.a, next.high.a);
        each(upper, own.low.b, next.low.b, outer[2 + n].a), each(upper + 1, own.high.a, next.high.a, outer[2 + n].b);
      };
      side(0), side(1);
    }
  }
  /// Between the corners.
  static HWY_INLINE F trilinear(const F c[8], const F f[3]) {
    const D d;
    return mixed(d, mixed(d, mixed(d, c[0], c[1], f[0]), mixed(d, c[2], c[3], f[0]), f[1]),
                 mixed(d, mixed(d, c[4], c[5], f[0]), mixed(d, c[6], c[7], f[0]), f[1]), f[2]);
  }
  /// The same on the way from + s * way.
  static HWY_INLINE Cubic<D> trilinear(const F c[8], const F from[3], const F way[3]) {
    const Pair<D> rows[4] = {{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}};
    return along_way(rows, from, way);
  }

 private:
  static HWY_INLINE I step(Mask<D> border, int there, int elsewhere) {
    const IntTag<D> di;
    return select(border, set(di, there), elsewhere);
  }

  const Source<D, T>& source_;
  const I corner_;
  Mask<D> first_[3], last_[3];
};

/// Differences over two cells along each axis at the corners of a cell.
template <class D, class T>
class CornerChanges {
  using F = Float<D>;

 public:
  HWY_INLINE void find(const Around<D, T>& around) {
    each(around, [](F before, F, F after) HWY_ATTR { return after - before; });
  }
  /// The same; where a neighbour is no number, twice the difference to the other one.
  HWY_NOINLINE void find_beside_holes(const Around<D, T>& around) {
    each(around, [](F before, F own, F after) HWY_ATTR {
      const F twice = own + own;
      const F lo = select(is_nan(before), twice - after, before);
      const F hi = select(is_nan(after), twice - before, after);
      const F change = hi - lo;
      return only(!is_nan(change), change);
    });
  }
  /// Along axis a, between the corners.
  HWY_INLINE F at(int a, const F share[3]) const { return Around<D, T>::trilinear(change_[a], share); }
  /// The same on the way from + s * way.
  HWY_INLINE Cubic<D> on(int a, const F from[3], const F way[3]) const { return Around<D, T>::trilinear(change_[a], from, way); }

 private:
  template <class Change>
  HWY_INLINE void each(const Around<D, T>& around, const Change& change) {
    Quad<D> rows[4];
    around.rows(rows);
    around.template neighbours<0>(rows, [&](int c, F x, F own, F y) HWY_ATTR { change_[0][c] = change(x, own, y); });
    around.template neighbours<1>(rows, [&](int c, F x, F own, F y) HWY_ATTR { change_[1][c] = change(x, own, y); });
    around.template neighbours<2>(rows, [&](int c, F x, F own, F y) HWY_ATTR { change_[2][c] = change(x, own, y); });
    for (int a = 0; a < 3; ++a) around.edge(a).mend_corners(change_[a], a, 2);
  }

  F change_[3][8];
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
