// SPDX-License-Identifier: Apache-2.0
// Lit samples of a packet: queued, lit a full vector at a time, added to their rays in the order of the samples.
#if defined(SG_PACKET_SHADING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_SHADING_INL_H
#undef SG_PACKET_SHADING_INL_H
#else
#define SG_PACKET_SHADING_INL_H
#endif

#include "render/volume/lattice/packets_inl.h"

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
      square = hn::Add(square, hn::Mul(hn::Mul(hn::Set(d, 0.25f), change), change));
    }
    return {out[0], out[1], out[2], hn::Sqrt(square)};
  }
};

template <class D, class T>
class ShadeQueue {
  using F = hn::Vec<D>;
  static constexpr size_t lanes_ = lanes_of<D>;
  enum { at_sample, at_r, at_g, at_b, at_flash, at_lane, parts };

 public:
  HWY_INLINE void start(const PacketPlan& plan, const RayPacket& rays) {
    count_ = 0;
    const D d;
    for (size_t l = 0; l < plan.lamps.size(); ++l) {
      // Half way between the light and the viewer.
      const Vec3 to = plan.lamps[l].direction;
      const F x = hn::Sub(hn::Set(d, float(to.x)), hn::Load(d, rays.direction[0])),
              y = hn::Sub(hn::Set(d, float(to.y)), hn::Load(d, rays.direction[1])),
              z = hn::Sub(hn::Set(d, float(to.z)), hn::Load(d, rays.direction[2]));
      const F length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
      const F per = hn::IfThenElseZero(hn::Gt(length, hn::Zero(d)), hn::Div(hn::Set(d, 1.0f), length));
      hn::Store(hn::Mul(x, per), d, half_[l][0]), hn::Store(hn::Mul(y, per), d, half_[l][1]), hn::Store(hn::Mul(z, per), d, half_[l][2]);
    }
  }

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
    const auto& m = plan.volume.shade_plan.to_world;
    const Material& material = plan.material;
    const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const Source<D, T> source(plan.volume.voxels);
    const auto lane = hn::IndicesFromVec(d, to_int(d, hn::Load(d, queue_[at_lane])));
    const F sample = hn::Load(d, queue_[at_sample]);
    const auto in_last = hn::Lt(sample, zero);
    F at[3];
    for (int a = 0; a < 3; ++a) {
      at[a] = hn::Add(of_lanes(rays.first[a], lane), hn::Mul(sample, of_lanes(rays.by[a], lane)));
      at[a] = hn::IfThenElse(in_last, of_lanes(rays.last[a], lane), at[a]);
    }
    const SlopeFinder<D, T> finder(source, at[0], at[1], at[2]);
    const Slope<D> g = finder.find();
    const F x = turned(g, m[0]), y = turned(g, m[1]), z = turned(g, m[2]);
    const F square = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
    const auto bent = hn::And(hn::Gt(square, zero), hn::Lt(square, hn::Set(d, 1e30f)));
    const F surface = hn::Min(hn::Mul(g.per_cell, hn::Set(d, plan.volume.shade_plan.per_scale)), one);
    const auto away =
        hn::Gt(dot(x, y, z, of_lanes(rays.direction[0], lane), of_lanes(rays.direction[1], lane), of_lanes(rays.direction[2], lane)), zero);
    const F side = hn::Div(hn::IfThenElse(away, hn::Set(d, -1.0f), one), hn::Sqrt(square));
    F diffuse = zero, specular = zero;
    for (size_t l = 0; l < plan.lamps.size(); ++l) {
      const Vec3f to(plan.lamps[l].direction);
      const F intensity = hn::Set(d, plan.lamps[l].intensity);
      const F c = hn::Mul(side, dot(x, y, z, hn::Set(d, to.x), hn::Set(d, to.y), hn::Set(d, to.z)));
      const auto lit = hn::Gt(c, zero);
      diffuse = hn::Add(diffuse, hn::IfThenElseZero(lit, hn::Mul(intensity, c)));
      F h =
          hn::Max(hn::Mul(side, dot(x, y, z, of_lanes(half_[l][0], lane), of_lanes(half_[l][1], lane), of_lanes(half_[l][2], lane))), zero);
      for (int i = 0; i < 5; ++i) h = hn::Mul(h, h);
      specular = hn::Add(specular, hn::IfThenElseZero(lit, hn::Mul(intensity, h)));
    }
    const F factor = hn::Sub(hn::Add(hn::Set(d, material.ambient), hn::Mul(hn::Set(d, material.diffuse), diffuse)), one);
    const F shade = hn::IfThenElse(bent, hn::Add(one, hn::Mul(surface, factor)), one);
    const F gloss = hn::IfThenElseZero(bent, hn::Mul(surface, hn::Mul(hn::Set(d, material.specular), specular)));
    const F flash = hn::Mul(hn::Load(d, queue_[at_flash]), gloss);
    for (const int i : {at_r, at_g, at_b}) hn::Store(hn::Add(hn::Mul(hn::Load(d, queue_[i]), shade), flash), d, queue_[i]);
    for (size_t n = 0; n < count; ++n) {
      const auto to = size_t(queue_[at_lane][n]);
      result.r[to] += queue_[at_r][n], result.g[to] += queue_[at_g][n], result.b[to] += queue_[at_b][n];
    }
  }
  static HWY_INLINE F dot(F x, F y, F z, F a, F b, F c) { return hn::Add(hn::Add(hn::Mul(a, x), hn::Mul(b, y)), hn::Mul(c, z)); }
  static HWY_INLINE F turned(const Slope<D>& g, const float* row) {
    const D d;
    return dot(g.x, g.y, g.z, hn::Set(d, row[0]), hn::Set(d, row[1]), hn::Set(d, row[2]));
  }
  template <class Indices>
  static HWY_INLINE F of_lanes(const float* values, const Indices& lane) {
    return hn::TableLookupLanes(hn::Load(D(), values), lane);
  }

  alignas(64) float half_[PacketPlan::most_lamps][3][most_lanes];
  alignas(64) float queue_[parts][3 * most_lanes];
  size_t count_;
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
