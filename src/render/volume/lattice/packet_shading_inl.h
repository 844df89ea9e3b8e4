// SPDX-License-Identifier: Apache-2.0
// Lit samples of a packet: queued, lit a full vector at a time, added to their rays in the order of the samples.
#if defined(SG_PACKET_SHADING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_SHADING_INL_H
#undef SG_PACKET_SHADING_INL_H
#else
#define SG_PACKET_SHADING_INL_H
#endif

#include "render/volume/lattice/packet_light_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// Differences of the field over one cell to each side of a place (one-sided at the border and beside NaN).
template <class D>
struct Slope {
  hn::Vec<D> x, y, z;   ///< in u
  hn::Vec<D> per_cell;  ///< change of the value over the length of a cell
};

template <class D, class T>
struct SlopeFinder {
  const Source<D, T>& source;
  Place<D> at[3];
  Int<D> lower[3], upper[3];          // cells one before and one after, inside the lattice
  hn::Vec<D> f_lower[3], f_upper[3];  // fractions there
  hn::Mask<D> first[3], last[3];      // in the first or last cell of an axis?
  bool inner = true;

  HWY_INLINE SlopeFinder(const Source<D, T>& s, hn::Vec<D> x, hn::Vec<D> y, hn::Vec<D> z) : source(s) {
    const D d;
    const IntTag<D> di;
    const hn::Vec<D> u[3] = {x, y, z};
    for (int a = 0; a < 3; ++a) {
      at[a] = source.place(a, u[a]);
      const auto in_first = hn::Eq(at[a].cell, hn::Zero(di)), in_last = hn::Eq(at[a].cell, source.last_cell[a]);
      first[a] = hn::RebindMask(d, in_first), last[a] = hn::RebindMask(d, in_last);
      inner = inner && hn::AllFalse(di, hn::Or(in_first, in_last));
      lower[a] = hn::Max(hn::Sub(at[a].cell, hn::Set(di, 1)), hn::Zero(di));
      upper[a] = hn::Min(hn::Add(at[a].cell, hn::Set(di, 1)), source.last_cell[a]);
      // Clamped to the border, a place is a sample.
      f_lower[a] = hn::IfThenElseZero(hn::Not(first[a]), at[a].fraction);
      f_upper[a] = hn::IfThenElse(last[a], hn::Set(d, 1.0f), at[a].fraction);
    }
  }

  /// Sum over x and y of four samples, at the fractions given.
  static HWY_INLINE hn::Vec<D> plane(const Pair<D>& p0, const Pair<D>& p1, hn::Vec<D> fx, hn::Vec<D> fy) {
    const D d;
    return mixed(d, mixed(d, p0.a, p0.b, fx), mixed(d, p1.a, p1.b, fx), fy);
  }

  /// Values before and after the place along each axis. Lanes at the border and others come out the same whoever is beside them.
  HWY_INLINE void values(hn::Vec<D> lo[3], hn::Vec<D> hi[3]) const {
    const D d;
    const auto fx = at[0].fraction, fy = at[1].fraction, fz = at[2].fraction;
    const Int<D> i = at[0].cell, j = at[1].cell, k = at[2].cell;
    if (!inner) {
      for (int a = 0; a < 3; ++a) {
        const Place<D> below{lower[a], f_lower[a]}, above{upper[a], f_upper[a]};
        lo[a] = source.value(a == 0 ? below : at[0], a == 1 ? below : at[1], a == 2 ? below : at[2]);
        hi[a] = source.value(a == 0 ? above : at[0], a == 1 ? above : at[1], a == 2 ? above : at[2]);
      }
      return;
    }
    // Rows (j, k), (j+1, k), (j, k+1), (j+1, k+1), four samples each from i-1 on.
    const auto corner = source.offset(i, j, k), row = source.row, layer = source.layer;
    const auto before = hn::Sub(corner, hn::Set(IntTag<D>(), 1)), after = hn::Add(corner, hn::Set(IntTag<D>(), 1));
    const Pair<D> a00 = source.pair(before), b00 = source.pair(after);
    const Pair<D> a01 = source.pair(hn::Add(before, row)), b01 = source.pair(hn::Add(after, row));
    const Pair<D> a10 = source.pair(hn::Add(before, layer)), b10 = source.pair(hn::Add(after, layer));
    const Pair<D> a11 = source.pair(hn::Add(before, hn::Add(row, layer))), b11 = source.pair(hn::Add(after, hn::Add(row, layer)));
    lo[0] = mixed(d, plane(a00, a01, fx, fy), plane(a10, a11, fx, fy), fz);
    hi[0] = mixed(d, plane(b00, b01, fx, fy), plane(b10, b11, fx, fy), fz);
    const auto m00 = mixed(d, a00.b, b00.a, fx), m01 = mixed(d, a01.b, b01.a, fx), m10 = mixed(d, a10.b, b10.a, fx),
               m11 = mixed(d, a11.b, b11.a, fx);
    lo[1] =
        mixed(d, mixed(d, line(hn::Sub(corner, row), fx), m00, fy), mixed(d, line(hn::Add(hn::Sub(corner, row), layer), fx), m10, fy), fz);
    const auto two_rows = hn::Add(row, row), two_layers = hn::Add(layer, layer);
    hi[1] = mixed(d, mixed(d, m01, line(hn::Add(corner, two_rows), fx), fy),
                  mixed(d, m11, line(hn::Add(hn::Add(corner, two_rows), layer), fx), fy), fz);
    lo[2] = mixed(d, mixed(d, line(hn::Sub(corner, layer), fx), line(hn::Add(hn::Sub(corner, layer), row), fx), fy), mixed(d, m00, m01, fy),
                  fz);
    hi[2] = mixed(d, mixed(d, m10, m11, fy),
                  mixed(d, line(hn::Add(corner, two_layers), fx), line(hn::Add(hn::Add(corner, two_layers), row), fx), fy), fz);
  }
  HWY_INLINE hn::Vec<D> line(Int<D> from, hn::Vec<D> fx) const {
    const Pair<D> p = source.pair(from);
    return mixed(D(), p.a, p.b, fx);
  }

  HWY_INLINE Slope<D> find() const {
    const D d;
    const auto one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
    hn::Vec<D> lo[3], hi[3], out[3];
    values(lo, hi);
    auto square = hn::Zero(d);
    for (int a = 0; a < 3; ++a) {
      auto change = hn::Sub(hi[a], lo[a]);
      auto slope = hn::Mul(change, half);
      if (!inner || !hn::AllFalse(d, hn::IsNaN(change))) {
        const auto middle = source.value(at[0], at[1], at[2]);
        const auto lo_good = hn::Eq(lo[a], lo[a]), hi_good = hn::Eq(hi[a], hi[a]);
        auto apart = hn::Add(hn::IfThenElse(first[a], at[a].fraction, one), hn::IfThenElse(last[a], hn::Sub(one, at[a].fraction), one));
        apart = hn::IfThenElse(lo_good, apart, hn::Mul(apart, half));
        apart = hn::IfThenElse(hi_good, apart, hn::Mul(apart, half));
        change = hn::Sub(hn::IfThenElse(hi_good, hi[a], middle), hn::IfThenElse(lo_good, lo[a], middle));
        slope = hn::Div(change, apart);
      }
      out[a] = slope;
      square = mul_add(hn::Mul(hn::Set(d, 0.25f), change), change, square);
    }
    return {out[0], out[1], out[2], hn::Sqrt(square)};
  }
};

template <class D, class T>
class ShadeQueue {
  using F = hn::Vec<D>;
  using I = Int<D>;
  static constexpr size_t lanes_ = lanes_of<D>;
  enum { at_sample, at_r, at_g, at_b, at_flash, at_lane, parts };

 public:
  HWY_INLINE void start(const PacketPlan& plan, const RayPacket& rays) { count_ = 0, lighting_ = Lighting<D>(plan, rays); }

  /// The number of the sample; negative: the last, shorter step. Colours and `flash` (the share of what is mirrored) are weighted already.
  HWY_INLINE void push(const PacketPlan& plan, const RayPacket& rays, PacketResult& result, hn::Mask<D> which, F sample, F r, F g, F b,
                       F flash) {
    const D d;
    const F part[parts] = {sample, r, g, b, flash, hn::ConvertTo(d, hn::Iota(IntTag<D>(), 0))};
    size_t n = 0;
    for (int i = 0; i < parts; ++i) n = hn::CompressStore(part[i], which, d, queue_[i] + count_);
    count_ += n;
    if (count_ < lanes_) return;
    light(plan, rays, result, lanes_);
    count_ -= lanes_;
    for (auto& q : queue_) hn::Store(hn::Load(d, q + lanes_), d, q);
  }
  HWY_INLINE void finish(const PacketPlan& plan, const RayPacket& rays, PacketResult& result) {
    if (count_ == 0) return;
    // What stands behind the last entry is old: any place will do.
    for (auto& q : queue_)
      for (size_t n = count_; n < lanes_; ++n) q[n] = q[0];
    light(plan, rays, result, count_);
  }

 private:
  HWY_NOINLINE void light(const PacketPlan& plan, const RayPacket& rays, PacketResult& result, size_t count) {
    const D d;
    const Source<D, T> source(plan.volume.voxels);
    const I order = to_int(d, hn::Load(d, queue_[at_lane]));
    const auto lane = hn::IndicesFromVec(d, order);
    const F sample = hn::Load(d, queue_[at_sample]);
    const auto in_last = hn::Lt(sample, hn::Zero(d));
    F at[3];
    for (int a = 0; a < 3; ++a) {
      at[a] = mul_add(sample, of_lanes(rays.by[a], lane), of_lanes(rays.first[a], lane));
      at[a] = hn::IfThenElse(in_last, of_lanes(rays.last[a], lane), at[a]);
    }
    const Slope<D> slope = SlopeFinder<D, T>(source, at[0], at[1], at[2]).find();
    const F cells[3] = {slope.x, slope.y, slope.z};
    F g[3];
    lighting_.to_world(cells, g);
    const Lighting<D> lighting = lighting_.permuted(order);
    const LitLanes<D> lit = lighting.on(lighting.surface(g, slope.per_cell));
    const F flash = hn::Mul(hn::Load(d, queue_[at_flash]), lit.specular);
    for (const int i : {at_r, at_g, at_b}) hn::Store(mul_add(hn::Load(d, queue_[i]), lit.diffuse, flash), d, queue_[i]);
    for (size_t n = 0; n < count; ++n) {
      const auto to = size_t(queue_[at_lane][n]);
      result.r[to] += queue_[at_r][n], result.g[to] += queue_[at_g][n], result.b[to] += queue_[at_b][n];
    }
  }
  template <class Indices>
  static HWY_INLINE F of_lanes(const float* values, const Indices& lane) {
    return hn::TableLookupLanes(hn::Load(D(), values), lane);
  }

  Lighting<D> lighting_;
  alignas(64) float queue_[parts][3 * most_lanes];
  size_t count_;
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
