// SPDX-License-Identifier: Apache-2.0
// Lit samples of a packet: queued, lit a full vector at a time, added to their rays in the order of the samples.
#if defined(SG_PACKET_SHADING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_SHADING_INL_H
#undef SG_PACKET_SHADING_INL_H
#else
#define SG_PACKET_SHADING_INL_H
#endif

#include "base/compress_inl.h"
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
class SlopeFinder {
  using F = hn::Vec<D>;

 public:
  HWY_INLINE SlopeFinder(const Source<D, T>& source, F x, F y, F z)
      : source_(source), at_{source.place(0, x), source.place(1, y), source.place(2, z)} {}

  HWY_INLINE Slope<D> find() const {
    const D d;
    const F half = hn::Set(d, 0.5f), f[3] = {at_[0].fraction, at_[1].fraction, at_[2].fraction};
    const Int<D> cell[3] = {at_[0].cell, at_[1].cell, at_[2].cell};
    const Around<D, T> around(source_, cell);
    CornerChanges<D, T> changes;
    changes.find(around);
    F change[3], slope[3];
    for (int a = 0; a < 3; ++a) change[a] = changes.at(a, f);
    if (std::is_same_v<T, float> && !hn::AllFalse(d, hn::IsNaN(hn::Add(change[0], hn::Add(change[1], change[2]))))) {
      changes.find_beside_holes(around);
      for (int a = 0; a < 3; ++a) change[a] = changes.at(a, f);
    }
    for (int a = 0; a < 3; ++a) slope[a] = hn::Mul(change[a], half);
    if (!around.inner)
      for (int a = 0; a < 3; ++a) slope[a] = hn::Div(change[a], around.apart(around.first[a], around.last[a], f[a]));
    auto square = hn::Zero(d);
    for (const F& c : change) square = mul_add(hn::Mul(hn::Set(d, 0.25f), c), c, square);
    return {slope[0], slope[1], slope[2], hn::Sqrt(square)};
  }

 private:
  const Source<D, T>& source_;
  const Place<D> at_[3];
};

/// The slopes at the places of the lanes that want them, found by vectors half as wide when those are few; the others' are anything.
template <class D, class T>
HWY_INLINE Slope<D> slopes_at(const Source<D, T>& source, [[maybe_unused]] const Voxels& voxels, const hn::Vec<D> u[3],
                              hn::Mask<D> wanted) {
  using F = hn::Vec<D>;
  const D d;
  // Lanes that want none look at the middle, which is no border that would have to be looked after.
  F v[3];
  for (int a = 0; a < 3; ++a) v[a] = hn::Mul(hn::Set(d, 0.5f), source.top[a]);
#if SG_HARDWARE_GATHERS && HWY_TARGET <= HWY_AVX3
  if constexpr (lanes_of<D> == 16) {
    using H = hn::Half<D>;
    if (hn::CountTrue(d, wanted) <= lanes_of<H>) {
      hn::Vec<H> few[3];
      for (int a = 0; a < 3; ++a) few[a].raw = _mm512_castps512_ps256(_mm512_mask_compress_ps(v[a].raw, wanted.raw, u[a].raw));
      const Slope<H> found = SlopeFinder<H, T>(Source<H, T>(voxels), few[0], few[1], few[2]).find();
      const auto back = [&](hn::Vec<H> x) HWY_ATTR { return F{_mm512_maskz_expand_ps(wanted.raw, _mm512_castps256_ps512(x.raw))}; };
      return {back(found.x), back(found.y), back(found.z), back(found.per_cell)};
    }
  }
#endif
  for (int a = 0; a < 3; ++a) v[a] = hn::IfThenElse(wanted, u[a], v[a]);
  return SlopeFinder<D, T>(source, v[0], v[1], v[2]).find();
}

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
    for (int i = 0; i < parts; ++i) n = sg::HWY_NAMESPACE::compress_store(d, part[i], which, queue_[i] + count_);
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
